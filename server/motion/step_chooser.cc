#include "server/motion/step_chooser.h"

#include <algorithm>

namespace handrail {
namespace {

// The nearest that a straight way from a to b comes to p [m].
double nearest_on_way(const Vec3& a, const Vec3& b, const Vec3& p) {
  const Vec3 way = b - a;
  const double part = way.squaredNorm() > 0.0 ? (p - a).dot(way) / way.squaredNorm() : 0.0;
  return (a + std::clamp(part, 0.0, 1.0) * way - p).norm();
}

}  // namespace

bool Ends::allow(const TipSpace& space, const MotionState& from, const TipMotion& next,
                 const StopPlan& stop) const noexcept {
  const Vec3& step = next.tip_step.linear;
  if (space.forward_S.dot(step) < -kTiny.place) return false;
  const bool turns =
      step.norm() < slow && kMotion.turn_length * next.tip_step.angular.norm() > step.norm();
  const double most = turns ? std::max(past, kTiny.waver) : past;
  // On a tool and in contact no step brings the place of rest further from the goal.
  const auto off = [&](const Vec3& p) { return (p - p_goal).norm(); };
  const bool held = space.freedom() < 3 || space.touched;
  if (held && off(stop.p_end) > std::max(off(rest_place(from)), most)) return false;
  const Vec3 way = p_goal - from.X_ST.p;
  const bool ahead = way.dot(step) > 0.0;
  if (ahead && (stop.p_end - p_goal).dot(way) > most * way.norm()) return false;
  return !stays || keep_near(from.X_ST.p, next.X_ST.p, stop.p_end);
}

bool Ends::keep_near(const Vec3& here, const Vec3& there, const Vec3& p_end) const noexcept {
  const auto off = [&](const Vec3& p) { return (p - p_target).norm(); };
  if (off(there) > std::max({least + kMotion.unheld, off(here), out})) return false;
  const double nearest = std::min(least, nearest_on_way(there, p_end, p_target));
  return off(p_end) <= std::max(nearest + kMotion.unheld, out);
}

TipMotion after(const PlanLimits& limits, const TipMotion& m, const JointVector& q,
                const Pose& X) noexcept {
  TipMotion next = m;
  advance(limits, next.joints, q);
  next.X_ST = X;
  next.tip_step = next.joints.step.isZero(0.0) ? Twist() : between(m.X_ST, X);
  next.tip_change = next.joints.change.isZero(0.0) ? Twist() : next.tip_step - m.tip_step;
  return next;
}

bool StepChooser::take_most(const JointVector& q, const Pose& X, PlaceInverse& inverse,
                            TipMotion& next) noexcept {
  const StopPlan& plan = state_.stop;
  const JointVector stop =
      plan.done() ? state_.joints.q : plan.q[static_cast<std::size_t>(plan.next)];
  if (take(q, X, Stopping::kAsOne, next)) return true;
  // What brings a tip out further than its plan does so by halves, too.
  for (const double part : {0.5, 0.25}) {
    if (ends_.out > 0.0) break;
    JointVector some = stop + part * (q - stop);
    if (!space_.everything()) {
      TipPlace tip = tip_;
      tip.turn(some - state_.joints.q);
      inverse.bring_to(space_.nearest(tip.p()), tip, some);
    }
    if (take(some, forward(limits_.guard.arm, some), Stopping::kAsOne, next)) return true;
  }
  return take(q, X, Stopping::kEach, next);
}

bool StepChooser::take(const JointVector& q, const Pose& X, Stopping how,
                       TipMotion& next) noexcept {
  const TipMotion m = after(limits_, state_, q, X);
  const bool on_space = (space_.nearest(m.X_ST.p) - m.X_ST.p).norm() < 2.0 * kTiny.off;
  Verdict why = on_space ? plan_allows(limits_, state_.joints, q) : Verdict{Reason::kToolTube, -1};
  TipPlace tip = tip_;
  tip.turn(q - state_.joints.q);
  if (why.reason == Reason::kNone && plan_stop(limits_, space_, m, tip, how, trial_, why)) {
    if (!ends_.allow(space_, state_, m, trial_) || !ends_on_way(m, how)) return false;
    next = m;
    state_.stop = trial_;
    return true;
  }
  if (refused_.reason == Reason::kNone) refused_ = why;
  return false;
}

bool StepChooser::ends_on_way(const TipMotion& m, Stopping how) const noexcept {
  if (how == Stopping::kAsOne && !space_.everything()) return true;
  const Vec3 way = trial_.p_end - m.X_ST.p;
  const Vec3& step = m.tip_step.linear;
  const double speed = step.norm();
  const double off = speed < kTiny.place ? way.norm() : way.cross(step).norm() / speed;
  if (off >= kMotion.unheld) return false;
  return how == Stopping::kAsOne || way.norm() < 0.5 * speed * trial_.size + kMotion.unheld;
}

}  // namespace handrail
