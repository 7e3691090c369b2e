// Small parts of Foxglove's messages.
#pragma once

#include <optional>

#include "proto/foxglove.pb.h"
#include "proto/operator.pb.h"
#include "server/base/spatial.h"
#include "server/base/time.h"
#include "server/base/units.h"

namespace handrail {

using Numbers = google::protobuf::RepeatedField<double>;

inline google::protobuf::Timestamp timestamp_of(Nanos calendar) {
  google::protobuf::Timestamp out;
  out.set_seconds(calendar / kSecond);
  out.set_nanos(static_cast<std::int32_t>(calendar % kSecond));
  return out;
}

// Three numbers in a unit; nothing: there are not three.
inline std::optional<Vec3> vector_of(const Numbers& in, double unit = 1.0) {
  if (in.size() != 3) return std::nullopt;
  return Vec3(unit * Vec3(in[0], in[1], in[2]));
}

// w x y z.
inline std::optional<Quat> turn_of(const Numbers& in) {
  if (in.size() != 4) return std::nullopt;
  return Quat(in[0], in[1], in[2], in[3]);
}

inline std::optional<Pose> pose_of(const pb::PoseMm& in) {
  const auto p = vector_of(in.position_mm(), kMm);
  const auto q = turn_of(in.quaternion());
  if (!p || !q) return std::nullopt;
  return Pose{*p, *q};
}

template <typename Vector>
void set_vector(Vector* out, const Vec3& v) {
  out->set_x(v.x());
  out->set_y(v.y());
  out->set_z(v.z());
}

inline void set_turn(foxglove::Quaternion* out, const Quat& q) {
  out->set_x(q.x());
  out->set_y(q.y());
  out->set_z(q.z());
  out->set_w(q.w());
}

inline void set_pose(foxglove::Pose* out, const Pose& X) {
  set_vector(out->mutable_position(), X.p);
  set_turn(out->mutable_orientation(), X.q);
}

// 0xRRGGBB, as the page has it.
inline void set_colour(foxglove::Color* out, unsigned rgb, double opacity = 1.0) {
  out->set_r((rgb >> 16 & 255u) / 255.0);
  out->set_g((rgb >> 8 & 255u) / 255.0);
  out->set_b((rgb & 255u) / 255.0);
  out->set_a(opacity);
}

// An entity that goes with its frame and stays until another of its name comes.
inline foxglove::SceneEntity& add_entity(foxglove::SceneUpdate& out, const char* id,
                                         const char* frame, Nanos calendar) {
  foxglove::SceneEntity& entity = *out.add_entities();
  *entity.mutable_timestamp() = timestamp_of(calendar);
  entity.set_id(id);
  entity.set_frame_id(frame);
  entity.set_frame_locked(true);
  return entity;
}

}  // namespace handrail
