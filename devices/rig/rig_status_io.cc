#include "devices/rig/rig_status_io.h"

#include <google/protobuf/stubs/logging.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "proto/rig.pb.h"
#include "server/base/plain_text.h"
#include "server/base/units.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

template <typename List>
void set_vector(const Vec3& v, double unit, List& out) {
  for (const double value : v) out.Add(value / unit);
}

void fill(const RigMoment& moment, pb::RigMoment& out) {
  out.set_number(moment.number);
  out.set_time_s(to_seconds(moment.at));
  set_vector(moment.X_ST.p, kMm, *out.mutable_tip()->mutable_position_mm());
  const Quat& q = moment.X_ST.q;
  for (const double value : {q.w(), q.x(), q.y(), q.z()}) out.mutable_tip()->add_quaternion(value);
  set_vector(moment.unbent, kMm, *out.mutable_unbent_mm());
  set_vector(moment.on_tip.force, 1.0, *out.mutable_force_n());
  set_vector(moment.on_tip.torque, 1.0, *out.mutable_torque_n_m());
  if (!moment.has_socket) return;
  pb::RigScrew& screw = *out.mutable_screw();
  screw.set_turned_deg(moment.turned / kDeg);
  if (std::isfinite(moment.depth)) screw.set_depth_mm(moment.depth / kMm);
  screw.set_off_flats_deg(moment.off_flats / kDeg);
  screw.set_slipped(moment.slipped);
  screw.set_jammed(moment.jammed);
}

std::string done() {
  pb::RigReply out;
  out.set_done(true);
  return out.SerializeAsString();
}

}  // namespace

std::string rig_refusal(const std::string& reason) {
  pb::RigReply out;
  out.set_done(false);
  out.set_reason(reason);
  return out.SerializeAsString();
}

void RigBoard::hear(const RigMoment& moment) {
  moments_.push_back(moment);
  if (moments_.size() > kKeptMoments) moments_.pop_front();
}

std::string RigBoard::answer(std::string_view bytes) {
  const google::protobuf::LogSilencer silence;  // it would write about garbage itself, and wait
  pb::RigOrder order;
  if (!order.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())))
    return rig_refusal(fmt::format("an order of {} bytes is garbled", bytes.size()));
  if (order.has_look()) {
    return look(order.look().has_since() ? std::optional(order.look().since()) : std::nullopt);
  }
  if (!order.has_play()) return rig_refusal("the order is none, expected look or play");
  const Status played = play(order.play().scene(), order.play().anew());
  return played ? done() : rig_refusal(played.message());
}

Status RigBoard::play(const std::string& scene, bool anew) {
  if (scene == scene_ && !anew) return Status::ok();
  const std::string place = "play: scene '" + shown(scene) + "'";
  const Result<Workpiece> piece = find_(scene);
  if (!piece) return Status::error(place + ": " + piece.message());
  const auto inside = play_(*piece);
  if (!inside) return Status::error(place + ": " + inside.message());
  if (*inside) {
    return Status::error(
        fmt::format("{}: the tip would be {:.1f} mm inside its {}: drive the arm out of it first",
                    place, (*inside)->deep / kMm, name_of((*inside)->what)));
  }
  scene_ = scene;
  // Those before were at another workpiece.
  moments_.clear();
  return Status::ok();
}

std::string RigBoard::look(std::optional<std::uint64_t> since) const {
  pb::RigReply out;
  out.set_done(true);
  pb::RigStatus& status = *out.mutable_status();
  if (!scene_.empty()) status.set_scene(scene_);
  if (moments_.empty()) return out.SerializeAsString();
  status.set_workpiece(moments_.back().workpiece);
  const auto is_before = [](const RigMoment& moment, std::uint64_t number) {
    return moment.number <= number;
  };
  auto first = since ? std::lower_bound(moments_.begin(), moments_.end(), *since, is_before)
                     : moments_.end() - 1;
  for (std::size_t i = 0; i < kMostMoments && first != moments_.end(); ++i, ++first)
    fill(*first, *status.add_moment());
  return out.SerializeAsString();
}

RigBoard::FindWorkpiece workpiece_finder(std::vector<std::string> folders) {
  return [folders = std::move(folders)](const std::string& name) -> Result<Workpiece> {
    const Result<Scene> scene = SceneLibrary(folders).load(name);
    if (!scene) return scene.status();
    return workpiece_of(*scene);
  };
}

}  // namespace handrail
