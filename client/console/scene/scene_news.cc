#include "client/console/scene/scene_news.h"

#include <array>
#include <cstdio>

#include "client/console/scene/map_picture.h"
#include "server/base/units.h"
#include "server/kinematics/rv2a.h"

namespace handrail {
namespace {

using Numbers = google::protobuf::RepeatedField<double>;

template <typename Vector>
void set_numbers(Numbers* out, const Vector& v, double unit) {
  for (Eigen::Index i = 0; i < v.size(); ++i) out->Add(v[i] / unit);
}

void set_place(pb::PoseMm* out, const Pose& X) {
  set_numbers(out->mutable_position_mm(), X.p, kMm);
  for (const double c : {X.q.w(), X.q.x(), X.q.y(), X.q.z()}) out->add_quaternion(c);
}

// At `at`, with Z along `axis`.
Pose along(const Vec3& at, const Vec3& axis) { return {at, smallest_turn(Vec3::UnitZ(), axis)}; }

struct BodyMaker {
  pb::SceneNews& out;

  pb::SceneBody& add(pb::SceneBody::Kind kind, const Pose& X, const SurfaceSpec& surface) const {
    pb::SceneBody& body = *out.add_body();
    body.set_kind(kind);
    set_place(body.mutable_pose(), X);
    body.set_friction(surface.friction);
    return body;
  }
  void operator()(const PlaneSpec& s) const {
    add(pb::SceneBody::PLANE, along(s.at, s.normal), s.surface);
  }
  void operator()(const BoxSpec& s) const {
    set_numbers(add(pb::SceneBody::BOX, s.X_SB, s.surface).mutable_size_mm(), Vec3(2.0 * s.half),
                kMm);
  }
  void operator()(const CylinderSpec& s) const {
    const auto kind = s.hole ? pb::SceneBody::TUBE : pb::SceneBody::CYLINDER;
    set_numbers(add(kind, along(s.at, s.axis), s.surface).mutable_size_mm(),
                Vec2(s.radius, 2.0 * s.half_length), kMm);
  }
  void operator()(const HexSocketSpec& s) const {
    set_numbers(add(pb::SceneBody::SOCKET, s.X_SK, s.surface).mutable_size_mm(),
                Vec2(s.across_flats, s.depth), kMm);
  }
  template <typename Other>
  void operator()(const Other&) const {}  // nothing to draw
};

void set_arm(const Scene& scene, pb::ArmShape& out) {
  const ArmGeometry arm;
  out.set_shoulder_x_mm(arm.a1 / kMm);
  out.set_shoulder_z_mm(arm.d1 / kMm);
  out.set_upper_arm_mm(arm.a2 / kMm);
  out.set_elbow_x_mm(-arm.a3 / kMm);
  out.set_forearm_mm(arm.d4 / kMm);
  out.set_flange_mm(kFlangeLength / kMm);
  out.set_tip_mm(scene.tip_length / kMm);
  if (scene.X_AT) set_place(out.mutable_mount(), *scene.X_AT);
  set_numbers(out.mutable_joint_lower_deg(), scene.limits.joints.lower, kDeg);
  set_numbers(out.mutable_joint_upper_deg(), scene.limits.joints.upper, kDeg);
}

void set_tool(const ToolCall& call, pb::SceneTool& out) {
  out.set_kind(name_of(call.kind));
  pb::ToolGeometry& geometry = *out.mutable_geometry();
  if (!call.at_present) set_numbers(geometry.mutable_anchor_mm(), call.p_SA, kMm);
  const auto unit = [](Numbers* to, const Vec3& v) {
    if (!v.isZero()) set_numbers(to, Vec3(v.normalized()), 1.0);
  };
  unit(geometry.mutable_direction(), call.direction_S);
  unit(geometry.mutable_normal(), call.normal_S);
  if (call.has_axis) unit(geometry.mutable_axis(), call.axis_S);
  if (call.has_end) set_numbers(geometry.mutable_end_mm(), call.p_SE, kMm);
  if (call.one_way) geometry.set_one_way(true);
}

void set_goals(const LinearTask& task, pb::SceneNews& out) {
  set_place(out.add_goal(), {task.p_SA, task.q_first});
  set_place(out.add_goal(), {task.p_SB, task.q_second()});
  set_place(out.add_goal(), {task.p_SC, task.q_second()});
}

std::string colour_text(const std::array<std::uint8_t, 3>& rgb) {
  std::array<char, 8> out{};
  std::snprintf(out.data(), out.size(), "#%02x%02x%02x", rgb[0], rgb[1], rgb[2]);
  return out.data();
}

const char* kind_text(RegionKind kind) {
  return kind == RegionKind::kFree ? "free" : kind == RegionKind::kWall ? "wall" : "aisle";
}

void set_regions(const Walls& walls, pb::SceneMap& out) {
  for (std::size_t i = 0; i < walls.regions.size(); ++i) {
    pb::SceneMap::Region& region = *out.add_region();
    region.set_name(walls.regions[i].name);
    region.set_kind(kind_text(walls.regions[i].kind));
    region.set_colour(colour_text(map_colour(walls, i)));
    if (!walls.regions[i].one_way.isZero()) {
      set_numbers(region.mutable_one_way(), walls.regions[i].one_way, 1.0);
    }
  }
  for (const WallStage& from : walls.stages) {
    pb::SceneMap::Stage& stage = *out.add_stage();
    if (!from.name.empty()) stage.set_name(from.name);
    set_numbers(stage.mutable_at_mm(), from.pose.p, kMm);
    stage.set_turn_deg(from.pose.angle / kDeg);
    for (const std::uint8_t gone : from.gone) {
      if (gone < walls.regions.size()) stage.add_without(walls.regions[gone].name);
    }
  }
}

void set_places(const EffectSpec& detent, pb::SceneMap& out) {
  for (std::size_t i = 0; i < detent.places.size(); ++i) {
    pb::SceneMap::Place& place = *out.add_place();
    if (i < detent.place_names.size()) place.set_name(detent.place_names[i]);
    set_numbers(place.mutable_at_mm(), detent.places[i], kMm);
    place.set_radius_mm((i < detent.radii.size() ? detent.radii[i] : detent.radius) / kMm);
  }
}

void set_map(const Scene& scene, const std::string& url, const Vec2& size, pb::SceneMap& out) {
  out.set_picture(url);
  set_numbers(out.mutable_size_mm(), size, kMm);
  set_regions(*scene.walls, out);
  for (const EffectSpec& effect : scene.effects) {
    if (effect.kind == EffectKind::kDetent) set_places(effect, out);
  }
  set_numbers(out.mutable_start_mm(), scene.walls->start, kMm);
}

}  // namespace

pb::SceneNews scene_news(const Scene& scene, const std::string& map_url, const Vec2& map_size) {
  pb::SceneNews out;
  out.set_name(scene.name);
  out.set_description(scene.description);
  out.set_scale(scene.mapping.scale);
  for (int row = 0; row < 3; ++row) {
    set_numbers(out.mutable_rotation(), Vec3(scene.mapping.R_SM.row(row).transpose()), 1.0);
  }
  if (scene.walls) {
    out.set_kind(pb::SceneNews::WALLS);
    set_map(scene, map_url, map_size, *out.mutable_map());
    return out;
  }
  out.set_kind(pb::SceneNews::ARM);
  set_arm(scene, *out.mutable_arm());
  set_numbers(out.mutable_workspace_low_mm(), scene.limits.workspace_low, kMm);
  set_numbers(out.mutable_workspace_high_mm(), scene.limits.workspace_high, kMm);
  for (const ToolCall& call : scene.tools) set_tool(call, *out.add_tool());
  if (scene.simulate) {
    for (const RigEffectSpec& effect : scene.simulate->effects) std::visit(BodyMaker{out}, effect);
  }
  if (scene.task) set_goals(*scene.task, out);
  return out;
}

}  // namespace handrail
