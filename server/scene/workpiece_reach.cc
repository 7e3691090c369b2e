#include "server/scene/workpiece_reach.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "server/base/plain_text.h"
#include "server/base/units.h"
#include "server/kinematics/arm_of.h"
#include "server/kinematics/rv2a.h"
#include "server/scene/field_check.h"

namespace handrail {
namespace {

constexpr double kRounding = 1e-9;  // beyond the end of a range or the workspace [rad], [m]
constexpr int kLast = kJoints - 1;  // turns the tip about its own axis and does nothing else
constexpr double kUnusual = 100.0;  // more than any joint is beyond its range [rad]

std::string rounded(double value) { return number_text(std::round(value * 10.0) / 10.0); }

// One way of the arm to stand.
struct Standing {
  JointVector q;         // [rad]
  int joint = 0;         // furthest beyond its range, or nearest to it
  double beyond = -1e9;  // by how much; below 0: within [rad]
};

// The way to stand at a pose that is furthest within the joint ranges, with room for half of `turn`
// either way; where none is within, one of those with the shoulder forward and the elbow up if
// there is one. Nothing where the wrist is too near or too far for any.
std::optional<Standing> stand(const Scene& scene, const Pose& X_ST, double turn) {
  const ArmGeometry arm = arm_of(scene);
  const JointLimits& limits = scene.limits.joints;
  const JointVector middle = 0.5 * (limits.lower + limits.upper);
  InverseSolutions all;
  inverse_all(arm, X_ST, JointVector::Zero(), all);
  std::optional<Standing> best;
  double least = 0.0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(all.count); ++k) {
    Standing now{all.q[k]};
    now.q[kLast] =
        middle[kLast] + std::remainder(now.q[kLast] - middle[kLast], 2 * std::numbers::pi);
    for (int i = 0; i < kJoints; ++i) {
      const double way = std::abs(now.q[i] - middle[i]) + (i == kLast ? 0.5 * turn : 0.0);
      const double beyond = way - 0.5 * (limits.upper[i] - limits.lower[i]);
      if (beyond <= now.beyond) continue;
      now.beyond = beyond;
      now.joint = i;
    }
    const bool unusual = all.branch[k].shoulder_back || all.branch[k].elbow_down;
    const double cost = now.beyond + (now.beyond > kRounding && unusual ? kUnusual : 0.0);
    if (best && cost >= least) continue;
    best = now;
    least = cost;
  }
  return best;
}

// "the wrist would be 900 mm from the shoulder, expected 31.8 to 531.8 mm".
std::string too_far(const Scene& scene, const Pose& X_ST) {
  const ArmGeometry arm = arm_of(scene);
  const Vec3 p_SW = X_ST.p - arm.wrist_to_tip(X_ST.q);
  const double forearm = std::hypot(arm.a3, arm.d4);
  const double far = std::hypot(p_SW.head<2>().norm() - arm.a1, p_SW.z() - arm.d1);
  return "the wrist would be " + rounded(far / kMm) + " mm from the shoulder, expected " +
         rounded(std::abs(arm.a2 - forearm) / kMm) + " to " + rounded((arm.a2 + forearm) / kMm) +
         " mm";
}

// Why the arm cannot stand at a pose and turn by half of `turn` either way; "" where it can.
std::string why_not(const Scene& scene, const Pose& X_ST, double turn) {
  const Scene::Limits& limits = scene.limits;
  for (int i = 0; i < 3; ++i) {
    const double low = limits.workspace_low[i], high = limits.workspace_high[i], p = X_ST.p[i];
    if (p >= low - kRounding && p <= high + kRounding) continue;
    return std::string(1, "xyz"[i]) + " would be " + rounded(p / kMm) +
           " mm, expected the workspace's " + rounded(low / kMm) + " to " + rounded(high / kMm) +
           " mm";
  }
  const std::optional<Standing> way = stand(scene, X_ST, turn);
  if (!way) return too_far(scene, X_ST);
  if (way->beyond <= kRounding) return "";
  const int i = way->joint;
  const double lower = limits.joints.lower[i], upper = limits.joints.upper[i];
  const double spread = i == kLast ? 0.5 * turn : 0.0;
  const double q = way->q[i] + (way->q[i] > 0.5 * (lower + upper) ? spread : -spread);
  return std::string({'J', static_cast<char>('1' + i)}) + " would be at " + rounded(q / kDeg) +
         " deg, expected " + rounded(lower / kDeg) + " to " + rounded(upper / kDeg) + " deg";
}

Problem check(const Scene& scene, const std::string& field, const std::string& where,
              const Pose& X_ST, double turn = 0.0) {
  const std::string why = why_not(scene, X_ST, turn);
  if (why.empty()) return std::nullopt;
  return FieldProblem{field, "out of the arm's reach: " + where + why};
}

Problem check_task(const Scene& scene, const LinearTask& task) {
  if (Problem p = check(scene, "task.a_mm", "", {task.p_SA, task.q_first})) return p;
  if (Problem p = check(scene, "task.b_mm", "", {task.p_SB, task.q_first})) return p;
  if (Problem p = check(scene, "task.turn_deg", "turned at b_mm ", {task.p_SB, task.q_second()})) {
    return p;
  }
  return check(scene, "task.c_mm", "", {task.p_SC, task.q_second()});
}

const HexSocketSpec* socket_of(const Scene& scene) {
  return scene.simulate ? scene.simulate->find<HexSocketSpec>() : nullptr;
}

// Where the file has it: the effects stand in its order.
std::string field_of_socket(const Scene& scene) {
  const auto& all = scene.simulate->effects;
  const auto at = std::find_if(all.begin(), all.end(), [](const RigEffectSpec& e) {
    return std::holds_alternative<HexSocketSpec>(e);
  });
  return "simulate.effect[" + std::to_string(at - all.begin()) + "].hex_socket.at_mm";
}

Problem check_socket(const Scene& scene, const HexSocketSpec& socket, double turn) {
  const Quat q = key_in_socket(scene);
  const Vec3 rim = socket.X_SK.p, out = socket.X_SK.q * Vec3::UnitZ();
  const double room = scene.screw ? turn : 0.0;
  const std::string field = field_of_socket(scene);
  if (Problem p = check(scene, field, "at the bottom of the socket ", {rim - socket.depth * out, q},
                        room)) {
    return p;
  }
  if (Problem p = check(scene, field, "at the rim of the socket ", {rim, q}, room)) return p;
  if (!scene.screw) return std::nullopt;
  if (Problem p = check(scene, "screw.start_mm", "", {rim + scene.screw->start, q}, room)) return p;
  return check(scene, "screw.clear_mm", "", {rim + scene.screw->clear * out, q}, room);
}

}  // namespace

Quat key_in_socket(const Scene& scene) noexcept {
  const Pose& X_SK = socket_of(scene)->X_SK;
  Quat first = X_SK.q * Quat(0.0, 0.0, 1.0, 0.0);
  const JointLimits& limits = scene.limits.joints;
  const double middle = 0.5 * (limits.lower[kLast] + limits.upper[kLast]);
  const std::optional<Standing> way = stand(scene, {X_SK.p, first}, 0.0);
  if (!way) return first;
  constexpr double kSixth = 60.0 * kDeg;
  const double turns = std::round((middle - way->q[kLast]) / kSixth);
  return first * rotation_exp(Vec3(0.0, 0.0, turns * kSixth));
}

std::optional<FieldProblem> out_of_reach(const Scene& scene, double turn) {
  if (scene.task) {
    if (Problem p = check_task(scene, *scene.task)) return p;
  }
  const HexSocketSpec* socket = socket_of(scene);
  return socket != nullptr ? check_socket(scene, *socket, turn) : std::nullopt;
}

}  // namespace handrail
