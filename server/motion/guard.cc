#include "server/motion/guard.h"

#include <algorithm>
#include <cmath>

#include "server/base/deletable.h"
#include "server/kinematics/jacobian.h"

namespace handrail {
namespace {

constexpr double kInside = 1.0 - 1e-9;  // room for rounding
constexpr double kRangeInside = 1e-9;   // [rad]
constexpr double kNoAngle = 1e6;        // [rad]

// How far the tip is inside, at the nearest face; negative outside [m].
double clearance_of(const Workspace& workspace, const Vec3& p) {
  return std::min((p - workspace.low).minCoeff(), (workspace.high - p).minCoeff());
}

Verdict joint_verdict(const GuardLimits& limits, const JointVector& wanted, const JointVector& step,
                      const JointVector& change, const JointVector& last_change) {
  for (int i = 0; i < kJoints; ++i) {
    const AxisLimits& l = limits.axis[static_cast<std::size_t>(i)];
    const double v = step[i], a = change[i];
    const double above = limits.upper[i] - wanted[i], below = wanted[i] - limits.lower[i];
    // Beyond its range a joint may stand or come back.
    const double up = v <= 0.0 && a <= 0.0 ? 0.0 : stop_reach(l, v, a) - above;
    const double down = v >= 0.0 && a >= 0.0 ? 0.0 : stop_reach(l, -v, -a) - below;
    if (kept(Check::kRange) && (up > 0.0 || down > 0.0))
      return {Reason::kJointRange, static_cast<std::int8_t>(i)};
    if (kept(Check::kSpeed) && stop_peak(l, v, a) > l.speed)
      return {Reason::kJointSpeed, static_cast<std::int8_t>(i)};
    if (kept(Check::kAcceleration) && std::abs(a) > l.acceleration) {
      return {Reason::kJointAcceleration, static_cast<std::int8_t>(i)};
    }
    if (kept(Check::kJerk) && std::abs(a - last_change[i]) > l.jerk)
      return {Reason::kJointJerk, static_cast<std::int8_t>(i)};
  }
  return {};
}

// How far every joint can still turn up and down while it stops [rad].
struct Reaches {
  Reaches(const GuardLimits& limits, const JointVector& step, const JointVector& change) {
    for (int i = 0; i < kJoints; ++i) {
      const AxisLimits& l = limits.axis[static_cast<std::size_t>(i)];
      up[i] = stop_reach(l, step[i], change[i]);
      down[i] = stop_reach(l, -step[i], -change[i]);
    }
  }
  JointVector up, down;
};

// stop_reach_at_most of all joints at once [rad].
JointVector most_turn(const GuardLimits& limits, const JointVector& step,
                      const JointVector& change) {
  const JointVector fast =
      step.cwiseAbs() + 0.5 * change.cwiseProduct(change).cwiseProduct(limits.per_jerk);
  return fast.cwiseProduct(fast.cwiseProduct(limits.half_per_acceleration) + limits.stop_time);
}

// How far those turns can take the tip, at most, beyond what is linear in them: the second
// derivative by joints i and j is no longer than the lever of the one nearer to the tip.
double bend(const GuardLimits& limits, const JointVector& turn) {
  double sum = 0.0, before = 0.0;
  for (int i = 0; i < kJoints; ++i) {
    sum += limits.lever[i] * turn[i] * (0.5 * turn[i] + before);
    before += turn[i];
  }
  return sum;
}

// Whether a tip at `p`, the arm at `q`, stays between the faces wherever each joint stops.
bool keeps_off_faces(const GuardLimits& limits, const JointVector& q, const Vec3& p,
                     const Reaches& reaches, const JointVector& turn) {
  const auto J = tip_jacobian(limits.arm, q).linear;
  const double more = bend(limits, turn);
  for (int k = 0; k < 3; ++k) {
    double high = p[k] + more, low = p[k] - more;
    for (int i = 0; i < kJoints; ++i) {
      const double up = J(k, i) * reaches.up[i], down = -J(k, i) * reaches.down[i];
      high += std::max({up, down, 0.0});
      low += std::min({up, down, 0.0});
    }
    if (high > limits.workspace.high[k] || low < limits.workspace.low[k]) return false;
  }
  return true;
}

// Whether the tip could stay in the workspace while every joint stops from
// `wanted`. `clearance` becomes a lower bound for `wanted`; it costs kinematics
// only where the last one does not do.
bool stays_inside(const GuardLimits& limits, const GuardState& state, const JointVector& wanted,
                  const JointVector& step, const JointVector& change, double& clearance) {
  clearance = state.clearance - limits.lever.dot(step.cwiseAbs());
  if (clearance > limits.furthest || clearance > limits.lever.dot(most_turn(limits, step, change)))
    return true;
  const Reaches reaches(limits, step, change);
  const JointVector turn = reaches.up.cwiseMax(reaches.down);
  const double needed = limits.lever.dot(turn);
  if (clearance > needed) return true;
  const Vec3 p = forward(limits.arm, wanted).p;
  clearance = clearance_of(limits.workspace, p);
  if (clearance >= needed || keeps_off_faces(limits, wanted, p, reaches, turn)) return true;
  // Found outside, the tip may stand or come back.
  const double now = clearance_of(limits.workspace, forward(limits.arm, state.q).p);
  return now < 0.0 && clearance >= now;
}

Verdict tip_verdict(const GuardLimits& limits, const GuardState& state, const JointVector& wanted,
                    const JointVector& step, const JointVector& change, double& clearance) {
  if (stays_inside(limits, state, wanted, step, change, clearance)) return {};
  if (!kept(Check::kWorkspace)) return {};
  return {Reason::kWorkspace, -1};
}

Verdict check(const GuardLimits& limits, const GuardState& state, const JointVector& wanted,
              double& clearance) {
  const JointVector step = wanted - state.q, change = step - state.step;
  // Huge numbers would leave nothing of the others.
  if (kept(Check::kFinite) && !(wanted.squaredNorm() < kNoAngle * kNoAngle)) {
    return {Reason::kCommandInvalid, -1};
  }
  if (!limits.plainly_hold(wanted, step, change, state.change)) {
    const Verdict verdict = joint_verdict(limits, wanted, step, change, state.change);
    if (verdict.reason != Reason::kNone) return verdict;
  }
  return tip_verdict(limits, state, wanted, step, change, clearance);
}

}  // namespace

GuardLimits::GuardLimits(const JointLimits& joints, const ArmGeometry& geometry,
                         const Workspace& box, double dt) noexcept
    : lower(joints.lower.array() + kRangeInside),
      upper(joints.upper.array() - kRangeInside),
      arm(geometry),
      workspace(box) {
  const double forearm = std::hypot(arm.a3, arm.d4), wrist = arm.tip_radius();
  lever << arm.a1 + arm.a2 + forearm + wrist, arm.a2 + forearm + wrist, forearm + wrist, wrist,
      wrist, arm.tip_aside();
  for (int i = 0; i < kJoints; ++i) {
    AxisLimits& l = axis[static_cast<std::size_t>(i)];
    l.speed = kInside * joints.max_speed[i] * dt;
    l.acceleration = kInside * joints.max_acceleration[i] * dt * dt;
    l.jerk = std::min(kInside * joints.max_jerk[i] * dt * dt * dt, 4.0 * l.acceleration);
    speed[i] = l.speed;
    acceleration[i] = l.acceleration;
    jerk[i] = l.jerk;
    per_jerk[i] = 1.0 / l.jerk;
    half_per_acceleration[i] = 0.5 / l.acceleration;
    stop_time[i] = 1.5 * l.acceleration / l.jerk + 1.0;
    plenty[i] = stop_reach_at_most(l, l.speed);
  }
  plain_lower = lower + plenty;
  plain_upper = upper - plenty;
  furthest = lever.dot(plenty);
}

Verdict guard_allows(const GuardLimits& limits, const GuardState& state,
                     const JointVector& wanted) noexcept {
  double clearance = 0.0;
  return check(limits, state, wanted, clearance);
}

Verdict guard_allows_tip(const GuardLimits& limits, const GuardState& state,
                         const JointVector& wanted, const JointVector& step,
                         const JointVector& change) noexcept {
  double clearance = 0.0;
  return tip_verdict(limits, state, wanted, step, change, clearance);
}

void guard_brake(const GuardLimits& limits, GuardState& state) noexcept {
  const JointVector before = state.q;
  for (int i = 0; i < kJoints; ++i) {
    const AxisLimits& l = limits.axis[static_cast<std::size_t>(i)];
    state.change[i] = stop_change(l, state.step[i], state.change[i]);
    state.step[i] += state.change[i];
    state.q[i] += state.step[i];
  }
  state.clearance -= limits.lever.dot((state.q - before).cwiseAbs());
}

Verdict guard(const GuardLimits& limits, GuardState& state, const JointVector& wanted) noexcept {
  double clearance = 0.0;
  const Verdict verdict = check(limits, state, wanted, clearance);
  if (verdict.reason != Reason::kNone) {
    guard_brake(limits, state);
    return verdict;
  }
  const JointVector step = wanted - state.q;
  state.change = step - state.step;
  state.step = step;
  state.q = wanted;
  state.clearance = clearance;
  return verdict;
}

}  // namespace handrail
