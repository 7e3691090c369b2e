#include "server/control/tip_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/control/guard.h"
#include "server/control/joint_brake.h"

namespace handrail {
namespace {

constexpr double kTurnSpeed = 6.0;  // turning faster than J6 ever could [rad/s]
constexpr double kArrived = 1e-12;  // [m], [rad]: below rounding
// Room for the path's curvature in joint space and for the wire's 32-bit floats, so that the guard,
// which takes no margin, never has to act.
// Room for the wire's 32-bit floats, so that the guard, which takes no margin, never has to act.
constexpr double kMargin = 0.97;
// A joint's acceleration is shared between the bend of the path in joint space at the present speed
// and the braking that must remain possible: bends may take this share ...
constexpr double kBendShare = 0.4;
// ... and braking takes what the bend leaves of this one, but at least the last.
constexpr double kBrakeShare = 0.9;
constexpr double kLeastBrakeShare = 0.3;
constexpr double kRangeReserve = 0.5;
constexpr double kPlentyOfRoom = 0.25;  // [rad]: no bend within a stopping distance takes as much
constexpr double kNearWrist = 0.2;      // |sin J5| under which J4 and J6 may bend sharply
constexpr double kAtEnd = 1e-9;         // [rad]
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

// The same pose with the wrist flipped: (J4 + pi, -J5, J6 + pi), turned the way nearest the seed. A
// path straight through J5 = 0 keeps J4 and J6 and changes the sign of J5; holding on to the sign
// would spin J4 and J6 by half a turn instead.
void take_nearer_wrist(const JointVector& seed, JointVector& q) {
  JointVector flipped = q;
  flipped[4] = -q[4];
  for (const int i : {3, 5}) {
    flipped[i] += q[i] > seed[i] ? -std::numbers::pi : std::numbers::pi;
  }
  if ((flipped - seed).cwiseAbs().maxCoeff() < (q - seed).cwiseAbs().maxCoeff()) q = flipped;
}

bool candidate(const MotionSettings& settings, const MotionState& state, const Twist& tip,
               Candidate& out) {
  out.tip = tip;
  out.X_ST.p = state.X_ST.p + tip.linear;
  out.X_ST.q = tip.angular.isZero(0.0) ? state.X_ST.q
                                       : (rotation_exp(tip.angular) * state.X_ST.q).normalized();
  JointVector q;
  if (inverse_near(settings.arm, out.X_ST, state.q, q) != InverseStatus::kOk) return false;
  if (std::abs(q[4]) < kNearWrist) take_nearer_wrist(state.q, q);
  out.step = q - state.q;
  return true;
}

void accept(const Candidate& c, MotionState& state) {
  state.q += c.step;
  state.step = c.step;
  state.X_ST = c.X_ST;
  state.tip_step = c.tip;
}

// How slowly the tip may go on along its last step: the joint that needs longest to stop decides.
struct Braking {
  double share = 0.0;                      // of the last tip step
  JointVector step = JointVector::Zero();  // the joint step that makes, nearly
};

Braking slowest(const MotionSettings& settings, const MotionState& state) {
  Braking out;
  if (standing(state)) return out;
  // Going on at the same speed takes this step, which differs from the last by the path's bend.
  Candidate c;
  const JointVector on = candidate(settings, state, state.tip_step, c) ? c.step : state.step;
  for (int i = 0; i < kJoints; ++i) {
    const double a = kMargin * settings.limits.max_acceleration[i] * settings.dt * settings.dt;
    const double needed = std::abs(state.step[i]) - a;
    if (needed > 0.0 && on[i] * state.step[i] > 0.0) {
      out.share = std::max(out.share, needed / std::abs(on[i]));
    }
  }
  out.share = std::min(out.share, 1.0);
  out.step = out.share * on;
  return out;
}

// Stops in joint space: for the cycle in which the straight path cannot be kept.
void brake_joints(const MotionSettings& settings, const StepBox& box, MotionState& state) {
  const Pose before = state.X_ST;
  state.step = joint_brake(settings, state, box);
  state.q += state.step;
  state.X_ST = forward(settings.arm, state.q);
  state.tip_step = {state.X_ST.p - before.p, rotation_log(state.X_ST.q * before.q.conjugate())};
}

// Speed at which the path may be followed, at most 1, in units of the candidate `c` a cycle; `half`
// is the joint step to its middle, `remaining` the way to the target in the same units. Slow enough
// for the bends, to stop on the target and to stop every joint before the end of its range;
// `at_range` says whether the last of these decided.
double allowed_speed(const MotionSettings& settings, const MotionState& state, const Candidate& c,
                     const JointVector& half, double remaining, bool& at_range) {
  const double size = c.tip.linear.norm() + c.tip.angular.norm();
  const double last = (state.tip_step.linear.norm() + state.tip_step.angular.norm()) / size;
  double speed = 1.0;
  double ranged = 1.0;      // what the ranges allow
  double stop = remaining;  // deceleration along the path, candidates a cycle^2
  for (int i = 0; i < kJoints; ++i) {
    const double a = settings.limits.max_acceleration[i] * settings.dt * settings.dt;
    // q(s) = slope s + bend s^2 / 2 through the middle and the end.
    const double slope = 4.0 * half[i] - c.step[i];
    const double bend = std::abs(4.0 * (c.step[i] - 2.0 * half[i]));
    if (bend * speed * speed > kBendShare * a) speed = std::sqrt(kBendShare * a / bend);
    const double brake = std::max(kLeastBrakeShare * a, kBrakeShare * a - bend * last * last);
    const double rate = std::max(std::abs(slope), std::abs(c.step[i]));
    if (rate * remaining > kBrakeShare * a) stop = std::min(stop, brake / rate);
    const double room = c.step[i] > 0.0 ? settings.limits.upper[i] - state.q[i]
                                        : state.q[i] - settings.limits.lower[i];
    const double toward = longest_stoppable(room, std::min(brake, 0.6 * a));
    if (rate * ranged > toward) ranged = toward / rate;
  }
  speed = std::min(speed, longest_stoppable(remaining, stop));
  at_range = ranged < speed;
  return std::min(speed, ranged);
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

// What braking may use of a joint's acceleration, and what planning leaves for it near a range's
// end.
StepBox braking_box(const MotionSettings& settings, const MotionState& state) {
  return step_box(settings.limits, state.q, state.step, settings.dt, kMargin, kMargin);
}
StepBox planning_box(const MotionSettings& settings, const MotionState& state) {
  return step_box(settings.limits, state.q, state.step, settings.dt, kMargin, kRangeReserve);
}

// kNone when the tip, having taken step `c`, could brake along it and every joint would still be in
// its range where it comes to rest; else what is in the way. Steps chosen so leave a way to stop on
// the path at any time.
Reason stopping_limit(const MotionSettings& settings, const MotionState& state,
                      const Candidate& c) {
  double cycles = 0.0;  // braking takes this many from the step's speed
  double room = 1e9;    // least room of a joint beyond a straight stop in joint space
  for (int i = 0; i < kJoints; ++i) {
    const double a = settings.limits.max_acceleration[i] * settings.dt * settings.dt;
    cycles = std::max(cycles, std::abs(c.step[i]) / (kRangeReserve * a));
  }
  const double further = 0.5 * cycles;  // way to rest, in units of the step
  for (int i = 0; i < kJoints; ++i) {
    const double end = state.q[i] + (1.0 + further) * c.step[i];
    room = std::min({room, settings.limits.upper[i] - end, end - settings.limits.lower[i]});
  }
  if (room > kPlentyOfRoom && std::abs(std::sin(state.q[4])) > kNearWrist) return Reason::kNone;
  MotionState there;
  there.q = state.q + c.step;
  there.X_ST = c.X_ST;
  Candidate rest;
  if (!candidate(settings, there, further * c.tip, rest)) return Reason::kOutOfReach;
  const JointVector q = there.q + rest.step;
  if ((settings.limits.upper - q).minCoeff() < -kAtEnd ||
      (q - settings.limits.lower).minCoeff() < -kAtEnd) {
    return Reason::kJointRange;
  }
  const double bent =
      0.5 * kBendShare * settings.dt * settings.dt * (cycles + 1.0) * (cycles + 1.0);
  const JointVector bend = (rest.step - further * c.step).cwiseAbs();
  return (bend - bent * settings.limits.max_acceleration).maxCoeff() > 0.0 ? Reason::kSingularity
                                                                           : Reason::kNone;
}

// Takes the longest blend between braking and `wanted` that the limits allow.
void step_between(const MotionSettings& settings, const StepBox& box, const Candidate& wanted,
                  MotionState& state) {
  const Braking braking = slowest(settings, state);
  const Twist slow = braking.share * state.tip_step;
  double share = box.largest_share(braking.step, wanted.step);
  Candidate c;
  for (int i = 0; i < 4 && share > 0.0; ++i, share *= 0.6) {
    if (candidate(settings, state, blend(slow, wanted.tip, share), c) && box.contains(c.step) &&
        stopping_limit(settings, state, c) == Reason::kNone) {
      accept(c, state);
      return;
    }
  }
  const StepBox last_resort = braking_box(settings, state);
  if (candidate(settings, state, slow, c) && last_resort.contains(c.step)) {
    accept(c, state);
  } else {
    brake_joints(settings, last_resort, state);
  }
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

  Candidate half;
  const bool known = candidate(settings, state, (0.5 * part) * way, half);
  bool at_range = false;
  const double speed = share * allowed_speed(settings, state, c, known ? half.step : 0.5 * c.step,
                                             1.0 / part, at_range);
  if (speed < 1.0 && !candidate(settings, state, (speed * part) * way, c)) {
    brake(settings, state);
    return Reason::kOutOfReach;
  }

  const StepBox box = planning_box(settings, state);
  Reason reason = Reason::kNone;
  if (!box.contains(c.step)) {
    reason = binding(settings, state, box, c.step);
  } else if (reason = stopping_limit(settings, state, c); reason == Reason::kNone) {
    accept(c, state);
    if (halvings > 0) return Reason::kOutOfReach;
    if (at_range) return Reason::kJointRange;
    return cycles > 1.0 && length > settings.tip_speed * settings.dt ? Reason::kTipSpeed
                                                                     : Reason::kNone;
  }
  step_between(settings, box, c, state);
  return reason;
}

void brake(const MotionSettings& settings, MotionState& state) noexcept {
  if (standing(state)) {
    state.tip_step = Twist();
    return;
  }
  const StepBox box = braking_box(settings, state);
  const double share = slowest(settings, state).share;
  if (share == 0.0) {
    state.step.setZero();
    state.tip_step = Twist();
    return;
  }
  Candidate c;
  if (candidate(settings, state, share * state.tip_step, c) && box.contains(c.step)) {
    accept(c, state);
  } else {
    brake_joints(settings, box, state);
  }
}

}  // namespace handrail
