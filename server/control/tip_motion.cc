#include "server/control/tip_motion.h"

#include <algorithm>
#include <cmath>

#include "server/control/guard.h"

namespace handrail {
namespace {

constexpr double kTurnSpeed = 6.0;  // turning faster than J6 ever could [rad/s]
constexpr double kArrived = 1e-12;  // [m], [rad]: below rounding
// Room for the path's curvature in joint space and for the wire's 32-bit floats, so that the guard,
// which takes no margin, never has to act.
constexpr double kMargin = 0.97;
constexpr double kStopMargin = 0.85;
constexpr int kHalvings = 6;

struct Candidate {
  Twist tip;         // tip step
  Pose X_ST;         // where it leads
  JointVector step;  // joint step
};

Twist operator*(double s, const Twist& t) { return {s * t.linear, s * t.angular}; }
Twist blend(const Twist& from, const Twist& to, double s) {
  return {from.linear + s * (to.linear - from.linear),
          from.angular + s * (to.angular - from.angular)};
}

bool candidate(const MotionSettings& settings, const MotionState& state, const Twist& tip,
               Candidate& out) {
  out.tip = tip;
  out.X_ST.p = state.X_ST.p + tip.linear;
  out.X_ST.q = tip.angular.isZero(0.0) ? state.X_ST.q
                                       : (rotation_exp(tip.angular) * state.X_ST.q).normalized();
  JointVector q;
  if (inverse_near(settings.arm, out.X_ST, state.q, q) != InverseStatus::kOk) return false;
  out.step = q - state.q;
  return true;
}

void accept(const Candidate& c, MotionState& state) {
  state.q += c.step;
  state.step = c.step;
  state.X_ST = c.X_ST;
  state.tip_step = c.tip;
}

// Share of the last tip step that may remain: the joint that needs longest to stop decides.
double brake_share(const MotionSettings& settings, const MotionState& state) {
  double share = 0.0;
  for (int i = 0; i < kJoints; ++i) {
    const double a = kMargin * settings.limits.max_acceleration[i] * settings.dt * settings.dt;
    const double last = std::abs(state.step[i]);
    if (last > a) share = std::max(share, 1.0 - a / last);
  }
  return share;
}

// Stops in joint space: for the cycle in which the straight path cannot be kept.
void brake_joints(const MotionSettings& settings, const StepBox& box, MotionState& state) {
  const Pose before = state.X_ST;
  state.step = box.brake;
  state.q += box.brake;
  state.X_ST = forward(settings.arm, state.q);
  state.tip_step = {state.X_ST.p - before.p, rotation_log(state.X_ST.q * before.q.conjugate())};
}

// Which limit of the box the step `to` breaks first.
Reason binding(const MotionSettings& settings, const MotionState& state, const StepBox& box,
               const JointVector& to) {
  if (singularity_margin(settings.arm, state.q).wrist < 0.05) return Reason::kSingularity;
  Reason reason = Reason::kJointAcceleration;
  for (int i = 0; i < kJoints; ++i) {
    if (to[i] <= box.high[i] && to[i] >= box.low[i]) continue;
    const double v = 0.9 * settings.limits.max_speed[i] * settings.dt;
    const double end = to[i] > 0.0 ? settings.limits.upper[i] : settings.limits.lower[i];
    if (std::abs(end - state.q[i]) < 1.0 * settings.limits.max_speed[i] * settings.dt) {
      return Reason::kJointRange;
    }
    if (std::abs(state.step[i]) > v) reason = Reason::kJointSpeed;
  }
  return reason;
}

// Takes the longest blend between braking and `wanted` that the limits allow.
void step_between(const MotionSettings& settings, const StepBox& box, const Candidate& wanted,
                  MotionState& state) {
  const double keep = brake_share(settings, state);
  const Twist slow = keep * state.tip_step;
  const JointVector slow_joints = keep * state.step;
  double share = box.largest_share(slow_joints, wanted.step);
  for (int i = 0; i < 4; ++i) {
    Candidate c;
    if (candidate(settings, state, blend(slow, wanted.tip, share), c) && box.contains(c.step)) {
      accept(c, state);
      return;
    }
    share = i < 2 ? 0.8 * share : 0.0;
  }
  brake_joints(settings, box, state);
}

}  // namespace

MotionState standing_at(const ArmGeometry& arm, const JointVector& q) noexcept {
  MotionState state;
  state.q = q;
  state.X_ST = forward(arm, q);
  return state;
}

Reason move_toward(const MotionSettings& settings, const Pose& target, double share,
                   MotionState& state) noexcept {
  Twist way{target.p - state.X_ST.p, rotation_log(target.q * state.X_ST.q.conjugate())};
  double length = way.linear.norm();
  double turn = way.angular.norm();
  if (length < kArrived) length = 0.0, way.linear.setZero();
  if (turn < kArrived) turn = 0.0, way.angular.setZero();
  if (length == 0.0 && turn == 0.0) {
    if (standing(state)) {
      state.tip_step = Twist();
      return Reason::kNone;
    }
    brake(settings, state);
    return Reason::kNone;
  }

  // At most one cycle of the way, in units of which the rest is `cycles` long.
  const double cycles = std::max(
      {1.0, length / (settings.tip_speed * settings.dt), turn / (kTurnSpeed * settings.dt)});
  Candidate c;
  double part = 1.0 / cycles;
  int halvings = 0;
  while (!candidate(settings, state, part * way, c)) {
    if (++halvings > kHalvings) {
      brake(settings, state);
      return Reason::kOutOfReach;
    }
    part *= 0.5;
  }

  // Slow enough to stop where the way ends, as joints go along it here.
  const double remaining = 1.0 / part;
  double a = 1e9;  // change of step a cycle, in units of the candidate
  for (int i = 0; i < kJoints; ++i) {
    const double d = std::abs(c.step[i]);
    if (d > 0.0) {
      a = std::min(
          a, kStopMargin * settings.limits.max_acceleration[i] * settings.dt * settings.dt / d);
    }
  }
  const double fraction = share * std::min(1.0, longest_stoppable(remaining, a));
  if (fraction < 1.0 && !candidate(settings, state, (fraction * part) * way, c)) {
    brake(settings, state);
    return Reason::kOutOfReach;
  }

  const StepBox box = step_box(settings.limits, state.q, state.step, settings.dt, kMargin);
  if (box.contains(c.step)) {
    accept(c, state);
    if (halvings > 0) return Reason::kOutOfReach;
    return cycles > 1.0 && length > settings.tip_speed * settings.dt ? Reason::kTipSpeed
                                                                     : Reason::kNone;
  }
  const Reason reason = binding(settings, state, box, c.step);
  step_between(settings, box, c, state);
  return reason;
}

void brake(const MotionSettings& settings, MotionState& state) noexcept {
  if (standing(state)) {
    state.tip_step = Twist();
    return;
  }
  const StepBox box = step_box(settings.limits, state.q, state.step, settings.dt, kMargin);
  const double keep = brake_share(settings, state);
  if (keep == 0.0) {
    state.step.setZero();
    state.tip_step = Twist();
    return;
  }
  Candidate c;
  if (candidate(settings, state, keep * state.tip_step, c) && box.contains(c.step)) {
    accept(c, state);
  } else {
    brake_joints(settings, box, state);
  }
}

}  // namespace handrail
