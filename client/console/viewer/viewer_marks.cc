// What is drawn: tools, forces, arm, work pieces. Sizes and colours are those of the page
// (client/console/page/src/scene3d), in metres.
#include <algorithm>

#include "client/console/viewer/message_parts.h"
#include "client/console/viewer/viewer_picture.h"

namespace handrail {
namespace {

constexpr unsigned kTool = 0x00a884, kTurn = 0xc2699a;
constexpr unsigned kToolForce = 0x2f8fff, kSpringForce = 0xa06bff, kContactForce = 0xff7a2e;
constexpr unsigned kDeviceForce = kToolForce, kShell = 0xe6e7e1, kMetal = 0x9aa4ad;
constexpr unsigned kWork = 0x7d8a94, kSteel = 0xb98a4a, kGoal = 0x18a070, kProxy = 0xffd23f;
constexpr double kReach = 0.250;         // how far a line without an end is drawn [m]
constexpr double kEdge = 0.200;          // of the plane that is drawn [m]
constexpr double kThin = 0.0005;         // of a sheet [m]
constexpr double kTurnArrow = 0.034;     // of a kept orientation [m]
constexpr double kAxis = 0.090;          // of a kept axis, to each side [m]
constexpr double kHandLength = 0.110;    // as long is the most that the device can push [m]
constexpr double kUsualMost = 3.3;       // of a device that does not say [N]
constexpr double kContactScale = 0.002;  // 50 N, the bumper's threshold, are 100 mm [m/N]
constexpr double kLongest = 0.150;       // [m]
constexpr double kLeastHand = 0.05, kLeastContact = 0.5;  // smaller ones are noise [N]

// At `at`, with `own` along `way`, which is not zero.
Pose along(const Vec3& at, const Vec3& own, const Vec3& way) {
  return {at, smallest_turn(own, way)};
}

void add_arrow(foxglove::SceneEntity& entity, const Vec3& from, const Vec3& way, double thick,
               unsigned rgb) {
  const double length = way.norm();
  if (length <= 0.0) return;
  foxglove::ArrowPrimitive& arrow = *entity.add_arrows();
  set_pose(arrow.mutable_pose(), along(from, Vec3::UnitX(), way));
  const double head = std::min(6.0 * thick, 0.5 * length);
  arrow.set_shaft_length(length - head);
  arrow.set_shaft_diameter(thick);
  arrow.set_head_length(head);
  arrow.set_head_diameter(3.0 * thick);
  set_colour(arrow.mutable_color(), rgb);
}

void add_ball(foxglove::SceneEntity& entity, const Vec3& at, double diameter, unsigned rgb) {
  foxglove::SpherePrimitive& ball = *entity.add_spheres();
  set_pose(ball.mutable_pose(), Pose{at, Quat::Identity()});
  set_vector(ball.mutable_size(), Vec3::Constant(diameter));
  set_colour(ball.mutable_color(), rgb);
}

void add_box(foxglove::SceneEntity& entity, const Pose& X, const Vec3& size, unsigned rgb,
             double opacity = 1.0) {
  foxglove::CubePrimitive& box = *entity.add_cubes();
  set_pose(box.mutable_pose(), X);
  set_vector(box.mutable_size(), size);
  set_colour(box.mutable_color(), rgb, opacity);
}

void add_cylinder(foxglove::SceneEntity& entity, const Pose& X, double diameter, double length,
                  unsigned rgb, double opacity = 1.0) {
  foxglove::CylinderPrimitive& body = *entity.add_cylinders();
  set_pose(body.mutable_pose(), X);
  set_vector(body.mutable_size(), Vec3(diameter, diameter, length));
  body.set_bottom_scale(1.0);
  body.set_top_scale(1.0);
  set_colour(body.mutable_color(), rgb, opacity);
}

void add_rod(foxglove::SceneEntity& entity, const Vec3& from, const Vec3& to, double diameter,
             unsigned rgb) {
  const Vec3 way = to - from;
  if (way.norm() <= 0.0) return;
  add_cylinder(entity, along(0.5 * (from + to), Vec3::UnitZ(), way), diameter, way.norm(), rgb);
}

void add_line(foxglove::SceneEntity& entity, const pb::ToolGeometry& g) {
  const auto at = vector_of(g.anchor_mm(), kMm), way = vector_of(g.direction());
  if (!at || !way) return;
  const auto end = vector_of(g.end_mm(), kMm);
  const Vec3 to = end ? *end : Vec3(*at + kReach * *way);
  add_arrow(entity, *at, to - *at, 0.0022, kTool);
  if (!g.one_way()) add_arrow(entity, *at, -kReach * *way, 0.0022, kTool);
}

void add_plane(foxglove::SceneEntity& entity, const pb::ToolGeometry& g) {
  const auto at = vector_of(g.anchor_mm(), kMm), normal = vector_of(g.normal());
  if (!at || !normal || normal->isZero()) return;
  add_box(entity, along(*at, Vec3::UnitZ(), *normal), Vec3(kEdge, kEdge, kThin), kTool, 0.35);
  add_arrow(entity, *at, 0.045 * *normal, 0.0022, kTool);
  const auto forward = vector_of(g.direction());
  if (g.one_way() && forward) add_arrow(entity, *at, 0.5 * kEdge * *forward, 0.0022, kTool);
}

void add_position_tool(foxglove::SceneEntity& entity, const pb::ToolStatus& tool) {
  const pb::ToolGeometry& g = tool.geometry();
  if (tool.kind() == "line") add_line(entity, g);
  if (tool.kind() == "plane") add_plane(entity, g);
  const auto at = vector_of(g.anchor_mm(), kMm);
  if (tool.kind() == "point" && at) add_ball(entity, *at, 0.010, kTool);
}

void add_orientation_tool(foxglove::SceneEntity& entity, const pb::ToolStatus& tool,
                          const Vec3& tip) {
  const pb::ToolGeometry& g = tool.geometry();
  const auto q = turn_of(g.quaternion());
  if (tool.kind() == "n-rotation" && q) {
    for (const Vec3& way : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY()), Vec3(Vec3::UnitZ())}) {
      add_arrow(entity, tip, kTurnArrow * (*q * way), 0.0018, kTurn);
    }
  }
  const auto axis = vector_of(g.axis());
  if (tool.kind() == "f-rotation" && axis && !axis->isZero()) {
    add_arrow(entity, tip - kAxis * *axis, 2.0 * kAxis * *axis, 0.0018, kTurn);
  }
}

// `scale` [m/N].
void add_force(foxglove::SceneEntity& entity, const Vec3& at, const Vec3& force, double scale,
               double least, unsigned rgb) {
  const double size = force.norm();
  if (size < least) return;
  add_arrow(entity, at, std::min(scale, kLongest / size) * force, 0.0048, rgb);
}

// [m/N]
double hand_scale(const pb::Status& status) {
  const double most = status.haptic().max_force_n();
  return kHandLength / (most > 0.0 ? most : kUsualMost);
}

Mat3 device_turn(const pb::SceneNews& scene) {
  Mat3 R = Mat3::Identity();
  for (int i = 0; i < 9 && scene.rotation_size() == 9; ++i) R(i / 3, i % 3) = scene.rotation(i);
  return R;
}

void add_arm_forces(foxglove::SceneEntity& entity, const pb::Status& status,
                    const pb::SceneNews& scene, const Vec3& tip) {
  const Mat3 R = device_turn(scene);
  const double scale = hand_scale(status);
  const auto tool = vector_of(status.tool_force().force_n());
  const auto spring = vector_of(status.spring_force().force_n());
  const auto contact = vector_of(status.contact_force_n());
  if (tool) add_force(entity, tip, R * *tool, scale, kLeastHand, kToolForce);
  if (spring) add_force(entity, tip, R * *spring, scale, kLeastHand, kSpringForce);
  if (contact && status.has_contact_force()) {
    add_force(entity, tip, *contact, kContactScale, kLeastContact, kContactForce);
  }
}

void add_arm(foxglove::SceneUpdate& out, const pb::ArmShape& arm, Nanos calendar) {
  const Vec3 origin = Vec3::Zero();
  const auto up = [](double mm) { return Vec3(0.0, 0.0, kMm * mm); };
  const Vec3 shoulder = kMm * Vec3(arm.shoulder_x_mm(), 0.0, arm.shoulder_z_mm());
  const Vec3 wrist = kMm * Vec3(arm.elbow_x_mm(), 0.0, arm.forearm_mm());
  add_rod(add_entity(out, "arm base", "base", calendar), origin, up(0.5 * arm.shoulder_z_mm()),
          0.190, kShell);
  const struct {
    const char *id, *frame;
    Vec3 from, to;
    double diameter;
    unsigned rgb;
  } rods[] = {{"arm shoulder", "link_1", up(0.5 * arm.shoulder_z_mm()), shoulder, 0.120, kShell},
              {"arm upper", "link_2", origin, up(arm.upper_arm_mm()), 0.095, kShell},
              {"arm fore", "link_3", origin, wrist, 0.080, kShell},
              {"arm wrist", "link_6", origin, up(arm.flange_mm()), 0.058, kShell},
              {"arm tool", "link_6", up(arm.flange_mm()), up(arm.tip_mm()), 0.012, kMetal}};
  for (const auto& rod : rods) {
    foxglove::SceneEntity& entity = add_entity(out, rod.id, rod.frame, calendar);
    add_ball(entity, rod.from, 1.1 * rod.diameter, kMetal);
    add_rod(entity, rod.from, rod.to, rod.diameter, rod.rgb);
    if (rod.id != std::string_view("arm tool") || arm.mount().position_mm_size() != 3) continue;
    const auto& aside = arm.mount().position_mm();
    const Vec3 tip = rod.to + kMm * Vec3(aside[0], aside[1], aside[2]);
    if (tip != rod.to) add_rod(entity, rod.to, tip, rod.diameter, rod.rgb);
  }
}

void add_body(foxglove::SceneEntity& entity, const pb::SceneBody& body) {
  const auto X = pose_of(body.pose());
  if (!X) return;
  const auto size = [&](int i) { return i < body.size_mm_size() ? kMm * body.size_mm(i) : 0.0; };
  switch (body.kind()) {
    case pb::SceneBody::PLANE: return add_box(entity, *X, Vec3(0.4, 0.4, kThin), kWork, 0.55);
    case pb::SceneBody::BOX: return add_box(entity, *X, Vec3(size(0), size(1), size(2)), kWork);
    case pb::SceneBody::CYLINDER: return add_cylinder(entity, *X, 2.0 * size(0), size(1), kWork);
    case pb::SceneBody::TUBE: return add_cylinder(entity, *X, 2.0 * size(0), size(1), kWork, 0.3);
    case pb::SceneBody::SOCKET: {
      const Pose middle = *X * Pose{Vec3(0.0, 0.0, -0.5 * size(1)), Quat::Identity()};
      return add_cylinder(entity, middle, std::max(0.018, 3.0 * size(0)), size(1), kSteel, 0.6);
    }
  }
}

}  // namespace

foxglove::SceneUpdate nothing_drawn(Nanos calendar) {
  foxglove::SceneUpdate out;
  foxglove::SceneEntityDeletion& all = *out.add_deletions();
  *all.mutable_timestamp() = timestamp_of(calendar);
  all.set_type(foxglove::SceneEntityDeletion::ALL);
  return out;
}

foxglove::SceneUpdate marks(const pb::Status& status, const pb::SceneNews& scene, Nanos calendar) {
  foxglove::SceneUpdate out;
  // An entity without parts takes the place of what was there.
  const auto entity = [&](const char* id, const char* frame) -> foxglove::SceneEntity& {
    return add_entity(out, id, frame, calendar);
  };
  if (scene.has_arm()) {
    const auto tip = pose_of(status.tip());
    add_position_tool(entity("position tool", "base"), status.position_tool());
    foxglove::SceneEntity& turn = entity("orientation tool", "base");
    if (tip) add_orientation_tool(turn, status.orientation_tool(), tip->p);
    foxglove::SceneEntity& forces = entity("forces", "base");
    if (tip) add_arm_forces(forces, status, scene, tip->p);
  }
  if (scene.has_map()) {
    const auto at = pose_of(status.hand());
    const auto force = vector_of(status.device_force().force_n());
    foxglove::SceneEntity& hand = entity("force at the hand", "device");
    if (at && force) {
      add_force(hand, at->p, *force, hand_scale(status), kLeastHand, kDeviceForce);
    }
    foxglove::SceneEntity& proxy = entity("proxy", "walls");
    const auto& place = status.walls().proxy_mm();
    if (place.size() == 2) add_ball(proxy, kMm * Vec3(place[0], place[1], 0.0), 0.004, kProxy);
  }
  return out;
}

foxglove::SceneUpdate work_cell(const pb::SceneNews& scene, Nanos calendar) {
  foxglove::SceneUpdate out = nothing_drawn(calendar);
  if (!scene.has_arm()) return out;
  add_arm(out, scene.arm(), calendar);
  foxglove::SceneEntity& bodies = add_entity(out, "work pieces", "base", calendar);
  for (const pb::SceneBody& body : scene.body()) add_body(bodies, body);
  foxglove::SceneEntity& goals = add_entity(out, "goals", "base", calendar);
  for (const pb::PoseMm& goal : scene.goal()) {
    if (const auto X = pose_of(goal)) add_ball(goals, X->p, 0.006, kGoal);
  }
  return out;
}

}  // namespace handrail
