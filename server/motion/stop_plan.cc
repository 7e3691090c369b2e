#include "server/motion/stop_plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/motion/place_solver.h"

namespace handrail {
namespace {

constexpr double kPlanned = 0.97;  // of the guard's limits: room for 32-bit floats on the wire
constexpr double kEarly = 0.135;   // of a full change: by so much stop_reach is too large at most
constexpr double kFromEnd = 1e-5;  // [rad]
constexpr double kRounding = 1.0 + 1e-6;  // so that a law at its limit passes
constexpr double kNearWrist = 0.2;        // |J5| under which J4 and J6 may turn sharply [rad]
constexpr double kNothing = 1e-12;        // [m], [rad]
constexpr double kLeastAcross = 0.05;     // of a limit, to end a bend with
constexpr double kAcrossJerk = 0.2;
constexpr double kOnPathJerk = 0.6;  // the rest is for the joints' own stops
constexpr double kLeastAlong = 0.2;
constexpr double kFarther = 2e-4;  // [m]

// Time to stop that is allowed, in cycles.
double stop_bound(const PlanLimits& limits, const JointVector& step) {
  double cycles = 0.0;
  for (int i = 0; i < kJoints; ++i) {
    const AxisLimits& l = limits.guard.axis[static_cast<std::size_t>(i)];
    cycles = std::max(cycles, std::abs(step[i]) / l.acceleration + 2.5 * l.acceleration / l.jerk);
  }
  return cycles;
}

// The motion split into along its present direction and across it.
struct Split {
  Vector6 along = Vector6::Zero(), across = Vector6::Zero();  // unit, or zero
  double speed = 0.0, along_change = 0.0, across_change = 0.0;
  JointVector along_rate, across_rate;  // |joint step| per unit
  double across_share = 0.0;            // of the joints' acceleration that the bend takes now
};

Split split_of(const PlanLimits& limits, const TipSpace& space, const TipMotion& from) {
  Split s;
  const Vector6 step = six({space.along(from.tip_step.linear), from.tip_step.angular});
  const Vector6 change = six({space.along(from.tip_change.linear), from.tip_change.angular});
  s.speed = step.norm();
  const bool moving = s.speed > kNothing;
  const double size = moving ? s.speed : change.norm();
  if (size < kNothing) {
    s.speed = 0.0;
    return s;
  }
  s.along = (moving ? step : change) / size;
  s.along_change = s.along.dot(change);
  const Vector6 bend = change - s.along_change * s.along;
  s.across_change = bend.norm();
  if (s.across_change > kNothing) s.across = bend / s.across_change;
  const JointVector rate = (moving ? from.joints.step : from.joints.change) / size;
  const JointVector rest = from.joints.change - s.along_change * rate;
  s.along_rate = rate.cwiseAbs();
  s.across_rate = s.across_change > kNothing ? JointVector(rest.cwiseAbs() / s.across_change)
                                             : JointVector(JointVector::Zero());
  for (int i = 0; i < kJoints; ++i) {
    s.across_share = std::max(
        s.across_share, std::abs(rest[i]) / limits.axis[static_cast<std::size_t>(i)].acceleration);
  }
  return s;
}

// Limits along a direction in which the joints turn at `rate`, with a share of
// what they can.
AxisLimits limits_along(const PlanLimits& limits, const JointVector& rate, double acceleration,
                        double jerk) {
  AxisLimits out{1e9, 1e9, 1e9};
  for (int i = 0; i < kJoints; ++i) {
    if (rate[i] < kNothing) continue;
    const AxisLimits& l = limits.axis[static_cast<std::size_t>(i)];
    out.acceleration = std::min(out.acceleration, acceleration * l.acceleration / rate[i]);
    out.jerk = std::min(out.jerk, jerk * l.jerk / rate[i]);
  }
  return out;
}

// Rolls one stop out, asking the guard at every cycle.
bool roll_out(const PlanLimits& limits, const TipSpace& space, const TipMotion& from,
              const Split& split, const AxisLimits& along, const AxisLimits& across, double bound,
              StopPlan& plan, Verdict& why) {
  AxisState u{0.0, split.speed, split.along_change}, n{0.0, 0.0, split.across_change};
  GuardState joints = from.joints;
  Pose X = from.X_ST;
  plan.size = plan.next = 0;
  while (plan.size < StopPlan::kCapacity && plan.size <= bound) {
    // Braking that began with more jerk than these laws have ends at rest all the same.
    u.a = std::max(stop_change(along, u.v, u.a), -u.v);
    u.v += u.a;
    n.a = std::max(stop_change(across, n.v, n.a), -n.v);
    n.v += n.a;
    const bool rest = u.v == 0.0 && n.v == 0.0;
    JointVector q = joints.q;
    if (!rest) {
      const Vector6 step = u.v * split.along + n.v * split.across;
      const Vec3 p = space.nearest(X.p + step.head<3>());
      if (space.forward_S.dot(p - X.p) < -kNothing) {
        why = {Reason::kToolTube, -1};
        return false;
      }
      X.p = p;
      X.q = (rotation_exp(step.tail<3>() / kTurnLength) * X.q).normalized();
      if (!solve_near(limits.guard.arm, X, joints.q, q)) {
        why = {Reason::kOutOfReach, -1};
        return false;
      }
    }
    const Verdict verdict = plan_allows(limits, joints, q);
    if (verdict.reason != Reason::kNone) {
      why = verdict;
      return false;
    }
    advance(limits, joints, q);
    plan.q[static_cast<std::size_t>(plan.size++)] = q;
    if (rest && u.a == 0.0 && n.a == 0.0) return true;
  }
  why = {Reason::kJointAcceleration, -1};
  return false;
}

// Rolls out a stop in which the tip keeps its path and every joint otherwise stops by itself: near
// singular poses, where the orientation cannot go on as it goes now.
bool roll_out_on_path(const PlanLimits& limits, const TipSpace& space, const TipMotion& from,
                      double share, double bound, StopPlan& plan, Verdict& why) {
  const PlaceSolver first(limits, from.joints.q);
  const Vec3 step = first.J * from.joints.step, change = first.J * from.joints.change;
  const double speed = step.norm();
  const Vec3 along = speed > kNothing ? Vec3(step / speed) : Vec3(Vec3::Zero());
  const double along_change = along.dot(change);
  const Vec3 bend = change - along_change * along;
  const double bending = bend.norm();
  const Vec3 across = bending > kNothing ? Vec3(bend / bending) : Vec3(Vec3::Zero());
  const AxisLimits u_limits =
      limits_along(limits, JointVector((first.R * along).cwiseAbs()), share, kOnPathJerk);
  const AxisLimits n_limits =
      limits_along(limits, JointVector((first.R * across).cwiseAbs()), share, kOnPathJerk);
  AxisState u{0.0, speed, along_change}, n{0.0, 0.0, bending};
  GuardState joints = from.joints;
  Vec3 p = from.X_ST.p;
  plan.size = plan.next = 0;
  while (plan.size < StopPlan::kCapacity && plan.size <= bound) {
    u.a = std::max(stop_change(u_limits, u.v, u.a), -u.v);
    u.v += u.a;
    n.a = std::max(stop_change(n_limits, n.v, n.a), -n.v);
    n.v += n.a;
    JointVector own;
    for (int i = 0; i < kJoints; ++i) {
      AxisLimits l = limits.axis[static_cast<std::size_t>(i)];
      l.acceleration = std::max(share * l.acceleration, std::abs(joints.change[i]));
      own[i] = joints.step[i] + stop_change(l, joints.step[i], joints.change[i]);
    }
    const bool rest = u.v == 0.0 && n.v == 0.0 && own.isZero(kNothing);
    JointVector q = joints.q;
    if (!rest) {
      const Vec3 p_next = space.nearest(p + u.v * along + n.v * across);
      if (space.forward_S.dot(p_next - p) < -kNothing) {
        why = {Reason::kToolTube, -1};
        return false;
      }
      p = p_next;
      const PlaceSolver here(limits, joints.q);
      q += own;
      here.correct(limits.guard.arm, p, q);
    }
    const Verdict verdict = plan_allows(limits, joints, q);
    if (verdict.reason != Reason::kNone) {
      why = verdict;
      return false;
    }
    advance(limits, joints, q);
    plan.q[static_cast<std::size_t>(plan.size++)] = q;
    if (rest && joints.change.isZero(0.0)) return true;
  }
  why = {Reason::kJointAcceleration, -1};
  return false;
}

// Every joint by its own stop law, which keeps what the guard keeps.
bool stop_joints(const PlanLimits& limits, const TipMotion& from, double bound, StopPlan& plan,
                 Verdict& why) {
  GuardState joints = from.joints;
  plan.size = plan.next = 0;
  while (plan.size < StopPlan::kCapacity && plan.size <= bound) {
    JointVector q = joints.q;
    for (int i = 0; i < kJoints; ++i) {
      q[i] += joints.step[i] + stop_change(limits.axis[static_cast<std::size_t>(i)], joints.step[i],
                                           joints.change[i]);
      if (std::abs(q[i] - joints.q[i]) < kNothing) q[i] = joints.q[i];
    }
    why = plan_allows(limits, joints, q);
    if (why.reason != Reason::kNone) return false;
    advance(limits, joints, q);
    plan.q[static_cast<std::size_t>(plan.size++)] = q;
    if (joints.step.isZero(0.0) && joints.change.isZero(0.0)) return true;
  }
  return false;
}

// Whether the stop ends less than `beside` [m] beside the tip's present way, and hardly farther
// along than by braking evenly: joints whose motions cancelled may take the tip far when each
// stops.
bool ends_near(const PlanLimits& limits, const TipMotion& from, const StopPlan& plan,
               double beside) {
  if (plan.size == 0) return true;
  const JointVector& q = plan.q[static_cast<std::size_t>(plan.size - 1)];
  const Vec3 way = forward(limits.guard.arm, q).p - from.X_ST.p;
  const Vec3& step = from.tip_step.linear;
  const double speed = step.norm();
  const double off = speed < kNothing ? way.norm() : way.cross(step).norm() / speed;
  return off < beside && way.norm() < 0.5 * speed * plan.size + kFarther;
}

}  // namespace

PlanLimits::PlanLimits(const GuardLimits& of) noexcept : guard(of), axis(of.axis) {
  for (AxisLimits& l : axis) {
    l.acceleration *= kPlanned;
    l.jerk *= kPlanned;
    from_end[static_cast<Eigen::Index>(&l - axis.data())] = kEarly * l.acceleration + kFromEnd;
    const double stoppable = 0.9 * (StopPlan::kCapacity - 4 - 2.5 * l.acceleration / l.jerk);
    l.speed = std::min(kPlanned * l.speed, stoppable * l.acceleration);
  }
}

Verdict plan_allows(const PlanLimits& limits, const GuardState& state,
                    const JointVector& wanted) noexcept {
  for (std::int8_t i = 0; i < kJoints; ++i) {
    const AxisLimits& l = limits.axis[static_cast<std::size_t>(i)];
    const double v = wanted[i] - state.q[i], a = v - state.step[i];
    if (!(stop_peak(l, v, a) <= kRounding * l.speed)) return {Reason::kJointSpeed, i};
    if (!(std::abs(a) <= kRounding * l.acceleration)) return {Reason::kJointAcceleration, i};
    if (!(std::abs(a - state.change[i]) <= kRounding * l.jerk)) return {Reason::kJointJerk, i};
  }
  // With the guard's own limits: its bound on reach is not the larger for
  // smaller ones.
  return guard_allows(limits.guard, state, wanted);
}

void advance(const PlanLimits& limits, GuardState& state, const JointVector& wanted) noexcept {
  const JointVector step = wanted - state.q;
  state.clearance -= limits.guard.lever.dot(step.cwiseAbs());
  state.change = step - state.step;
  state.step = step;
  state.q = wanted;
}

bool solve_near(const ArmGeometry& arm, const Pose& X, const JointVector& seed,
                JointVector& q) noexcept {
  if (inverse_near(arm, X, seed, q) != InverseStatus::kOk) return false;
  if (std::abs(q[4]) >= kNearWrist) return true;
  JointVector flipped = q;
  flipped[4] = -q[4];
  for (const int i : {3, 5}) {
    flipped[i] += q[i] > seed[i] ? -std::numbers::pi : std::numbers::pi;
  }
  if ((flipped - seed).cwiseAbs().maxCoeff() < (q - seed).cwiseAbs().maxCoeff()) q = flipped;
  return true;
}

bool plan_stop(const PlanLimits& limits, const TipSpace& space, const TipMotion& from,
               double beside, StopPlan& plan, Verdict& why) noexcept {
  plan.size = plan.next = 0;
  const Split split = split_of(limits, space, from);
  if (split.along.isZero(0.0) && from.joints.step.isZero(kNothing)) return true;
  const double bound = stop_bound(limits, from.joints.step);
  const double across_share = std::max(1.02 * split.across_share, kLeastAcross);
  const AxisLimits across = limits_along(limits, split.across_rate, across_share, kAcrossJerk);
  // The hardest stop first; whether the bend of the path leaves enough for it
  // shows in the roll-out.
  const double reserved = 0.97 - across_share;
  for (const double share : {0.97, 0.873, 0.7, reserved - 0.03, reserved - 0.15, reserved - 0.35}) {
    const double used = std::max(share, kLeastAlong);
    const AxisLimits along = limits_along(limits, split.along_rate, used, std::min(used, 0.93));
    if (roll_out(limits, space, from, split, along, across, bound, plan, why)) return true;
  }
  if (beside > 0.0 && stop_joints(limits, from, bound, plan, why) &&
      ends_near(limits, from, plan, beside)) {
    return true;
  }
  for (const double share : {0.85, 0.5}) {
    if (roll_out_on_path(limits, space, from, share, bound, plan, why)) return true;
  }
  plan.size = plan.next = 0;
  return false;
}

}  // namespace handrail
