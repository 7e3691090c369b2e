#include "client/console/viewer/viewer_picture.h"

#include "client/console/viewer/message_parts.h"

namespace handrail {
namespace {

struct FrameMaker {
  foxglove::FrameTransforms& out;
  const google::protobuf::Timestamp at;

  void add(const char* parent, const char* child, const Pose& X) const {
    foxglove::FrameTransform& transform = *out.add_transforms();
    *transform.mutable_timestamp() = at;
    transform.set_parent_frame_id(parent);
    transform.set_child_frame_id(child);
    set_vector(transform.mutable_translation(), X.p);
    set_turn(transform.mutable_rotation(), X.q);
  }
  void add(const char* parent, const char* child, const pb::PoseMm& pose) const {
    if (const auto X = pose_of(pose)) add(parent, child, *X);
  }
};

Quat about(const Vec3& axis, double angle_deg) {
  return Quat(Eigen::AngleAxisd(angle_deg * kDeg, axis));
}

// The chain of pb::ArmShape.
void add_links(const FrameMaker& frames, const pb::ArmShape& arm, const Numbers& joints_deg) {
  if (joints_deg.size() != 6) return;
  const Vec3 y = Vec3::UnitY(), z = Vec3::UnitZ();
  const struct {
    const char* frame;
    Vec3 p_mm, axis;
  } links[] = {{"link_1", Vec3::Zero(), z},
               {"link_2", {arm.shoulder_x_mm(), 0.0, arm.shoulder_z_mm()}, y},
               {"link_3", {0.0, 0.0, arm.upper_arm_mm()}, y},
               {"link_4", {arm.elbow_x_mm(), 0.0, arm.forearm_mm()}, z},
               {"link_5", Vec3::Zero(), y},
               {"link_6", Vec3::Zero(), z}};
  const char* parent = "base";
  for (int i = 0; i < 6; ++i) {
    frames.add(parent, links[i].frame,
               Pose{kMm * links[i].p_mm, about(links[i].axis, joints_deg[i])});
    parent = links[i].frame;
  }
  frames.add(parent, "flange", Pose{Vec3(0.0, 0.0, kMm * arm.flange_mm()), Quat::Identity()});
}

Pose pose_of_stage(const pb::SceneMap& map, std::uint32_t stage) {
  if (stage >= static_cast<std::uint32_t>(map.stage_size())) return {};
  const auto& at = map.stage(static_cast<int>(stage));
  Pose out{Vec3::Zero(), about(Vec3::UnitZ(), at.turn_deg())};
  if (at.at_mm_size() == 2) out.p = kMm * Vec3(at.at_mm(0), at.at_mm(1), 0.0);
  return out;
}

// R_SM, row by row.
Quat turn_of_device(const pb::SceneNews& scene) {
  if (scene.rotation_size() != 9) return Quat::Identity();
  Mat3 R;
  for (int i = 0; i < 9; ++i) R(i / 3, i % 3) = scene.rotation(i);
  return Quat(R);
}

}  // namespace

foxglove::FrameTransforms frame_transforms(const pb::Status& status, const pb::SceneNews& scene,
                                           Nanos calendar) {
  foxglove::FrameTransforms out;
  const FrameMaker frames{out, timestamp_of(calendar)};
  if (scene.has_arm()) {
    frames.add("world", "base", Pose{});
    add_links(frames, scene.arm(), status.joints_deg());
    frames.add("base", "tip", status.tip());
    frames.add("base", "ghost", status.desired_tip());
    frames.add("world", "device", Pose{Vec3::Zero(), turn_of_device(scene)});
  } else {
    frames.add("world", "device", Pose{});
  }
  frames.add("device", "hand", status.hand());
  if (scene.has_map()) {
    frames.add("device", "walls", pose_of_stage(scene.map(), status.walls().stage()));
  }
  return out;
}

foxglove::JointStates joint_states(const pb::Status& status, Nanos calendar) {
  foxglove::JointStates out;
  *out.mutable_timestamp() = timestamp_of(calendar);
  for (int i = 0; i < status.joints_deg_size(); ++i) {
    foxglove::JointState& joint = *out.add_joints();
    joint.set_name(std::string("J").append(std::to_string(i + 1)));
    joint.set_position(kDeg * status.joints_deg(i));
  }
  return out;
}

foxglove::PoseInFrame pose_in_frame(const pb::PoseMm& pose, Nanos calendar) {
  foxglove::PoseInFrame out;
  *out.mutable_timestamp() = timestamp_of(calendar);
  out.set_frame_id("base");
  if (const auto X = pose_of(pose)) set_pose(out.mutable_pose(), *X);
  return out;
}

foxglove::Grid map_grid(const MapCells& cells, Nanos calendar) {
  foxglove::Grid out;
  const bool there = cells.columns > 0 && cells.rows > 0;
  *out.mutable_timestamp() = timestamp_of(calendar);
  out.set_frame_id(there ? "walls" : "world");
  const Vec2 half = 0.5 * cells.size;
  set_pose(out.mutable_pose(), Pose{Vec3(-half.x(), -half.y(), 0.0), Quat::Identity()});
  constexpr std::uint32_t kCell = 4;  // bytes: red, green, blue, alpha
  std::uint32_t offset = 0;
  for (const char* name : {"red", "green", "blue", "alpha"}) {
    foxglove::PackedElementField& field = *out.add_fields();
    field.set_name(name);
    field.set_offset(offset++);
    field.set_type(foxglove::PackedElementField::UINT8);
  }
  const int columns = there ? cells.columns : 1;
  out.set_column_count(static_cast<std::uint32_t>(columns));
  out.set_cell_stride(kCell);
  out.set_row_stride(kCell * static_cast<std::uint32_t>(columns));
  out.mutable_cell_size()->set_x(there ? cells.size.x() / columns : kMm);
  out.mutable_cell_size()->set_y(there ? cells.size.y() / cells.rows : kMm);
  std::string& data = *out.mutable_data();
  if (!there) data.assign(kCell, '\0');
  data.reserve(cells.rgb.size() / 3 * kCell + kCell);
  for (std::size_t i = 0; i + 2 < cells.rgb.size(); i += 3) {
    data.append(cells.rgb, i, 3);
    data += '\xff';
  }
  return out;
}

}  // namespace handrail
