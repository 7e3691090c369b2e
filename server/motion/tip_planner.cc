#include "server/motion/tip_planner.h"

#include <algorithm>

#include "server/kinematics/reach.h"
#include "server/motion/slide.h"

namespace handrail {
namespace {

constexpr int kAround = 70;  // cycles
// With 0.05 an arm that turns through a straight wrist waits there for the hand; with 0.12 one
// whose wrist unwinds takes the tip as far away [m].
constexpr double kDetourMost = 0.085;
constexpr double kGoing = 1e-5;       // slower is standing [rad]
constexpr double kNearly = 1e-2;      // [rad]
constexpr int kStraightAgain = 15;    // straight steps in a row end a slide
constexpr double kAhead = 0.95;       // cosine: the tip moves toward its goal
constexpr double kPasses = 1e-7;      // [m]
constexpr double kPassesFree = 1e-4;  // off its tool [m]
constexpr double kAnywhere = 1e9;     // [m]
constexpr double kGoesBack = 1e-12;   // [m]

// The state after commanding `q`, whose tip is at X.
void move_to(const PlanLimits& limits, const JointVector& q, const Pose& X, TipMotion& m) {
  const Twist step = between(m.X_ST, X);
  advance(limits, m.joints, q);
  m.tip_change = step - m.tip_step;
  m.tip_step = step;
  m.X_ST = X;
  if (m.joints.step.isZero(0.0)) {
    m.tip_step = Twist();
    if (m.joints.change.isZero(0.0)) m.tip_change = Twist();
  }
}

}  // namespace

void play(const PlanLimits& limits, MotionState& state) noexcept {
  JointVector q = state.joints.q;
  if (!state.stop.done()) q = state.stop.q[static_cast<std::size_t>(state.stop.next++)];
  const bool same = q == state.joints.q;
  move_to(limits, q, same ? state.X_ST : forward(limits.guard.arm, q), state);
}

bool TipPlanner::straight(const Twist& step) noexcept {
  Pose X;
  X.p = space_.nearest(state_.X_ST.p + step.linear);
  X.q = step.angular.isZero(0.0) ? state_.X_ST.q
                                 : (rotation_exp(step.angular) * state_.X_ST.q).normalized();
  JointVector q;
  if (!solve_near(limits_.guard.arm, X, state_.joints.q, q)) {
    return refuse({Reason::kOutOfReach, -1});
  }
  if (!take(q, X, beside_)) return false;
  state_.around = 0;
  return true;
}

Twist TipPlanner::next_of_stop() const noexcept {
  if (state_.stop.done()) return {};
  const JointVector& q = state_.stop.q[static_cast<std::size_t>(state_.stop.next)];
  return between(state_.X_ST, forward(limits_.guard.arm, q));
}

bool TipPlanner::slower(const Ways& ways, const Twist& first, const Twist& second) noexcept {
  const Twist more = ways.gentle - ways.stop;
  for (const Twist& step :
       {first, second, ways.gentle, ways.stop + 0.6 * more, ways.stop + 0.3 * more}) {
    const bool going = step.linear.norm() + kTipLever * step.angular.norm() > kGoing * kTipLever;
    if (going && straight(step)) return true;
  }
  return false;
}

bool TipPlanner::otherwise(const Ways& ways, const JointVector& there, double speed,
                           bool stuck) noexcept {
  state_.sliding = kStraightAgain;
  if (state_.around == 0) {
    for (const Twist* step : {&ways.wanted, &ways.gentle, &ways.stop}) {
      if (sliding(there, state_.X_ST.p + step->linear, speed)) return true;
    }
  }
  const bool begins = stuck && ends(state_.stop) &&
                      detour(limits_.guard.arm, state_.joints.q, there, p_goal_) < kDetourMost;
  if (!space_.everything() || (state_.around == 0 && !begins)) return false;
  state_.around = state_.around > 0 ? state_.around - 1 : kAround;
  for (const double share : {1.0, 0.4, 0.15}) {
    if (by_joints(there, share * speed, kAnywhere)) return true;
  }
  return false;
}

bool TipPlanner::by_joints(const JointVector& there, double speed, double beside,
                           const Vec3* from) noexcept {
  const JointVector q = own_way(limits_, state_.joints, there, speed);
  const Pose X = forward(limits_.guard.arm, q);
  if (from != nullptr && (X.p - *from).norm() > (state_.X_ST.p - *from).norm()) return false;
  return (X.p - state_.X_ST.p).norm() <= settings_.tip_speed * settings_.dt && take(q, X, beside);
}

bool TipPlanner::sliding(const JointVector& there, const Vec3& p, double speed) noexcept {
  JointVector q;
  if (!slide(limits_, space_, state_, there, p, speed, q)) {
    return refuse({Reason::kOutOfReach, -1});
  }
  const bool going = (q - state_.joints.q).cwiseAbs().maxCoeff() > kGoing ||
                     (there - q).cwiseAbs().maxCoeff() < kNearly;
  return going && take(q, forward(limits_.guard.arm, q), beside_);
}

bool TipPlanner::refuse(const Verdict& why) noexcept {
  if (refused_.reason == Reason::kNone) refused_ = why;
  return false;
}

bool TipPlanner::take(const JointVector& q, const Pose& X, double beside) noexcept {
  if (space_.forward_S.dot(X.p - state_.X_ST.p) < -kGoesBack) {
    return refuse({Reason::kToolTube, -1});
  }
  const Verdict verdict = plan_allows(limits_, state_.joints, q);
  if (verdict.reason != Reason::kNone) return refuse(verdict);
  TipMotion next = state_;
  move_to(limits_, q, X, next);
  Verdict why;
  if (!plan_stop(limits_, space_, next, beside, trial_, why)) return refuse(why);
  if (passes(next)) return refuse({Reason::kJointAcceleration, -1});
  if (p_stay_ && leaves(X.p)) {
    return refuse({Reason::kOutOfReach, -1});
  }
  static_cast<TipMotion&>(state_) = next;
  state_.stop = trial_;
  return true;
}

bool TipPlanner::leaves(const Vec3& p) const noexcept {
  const auto off = [&](const Vec3& place) { return (place - *p_stay_).norm(); };
  const double stops = off(end_of(state_.stop, state_.X_ST.p));
  // A tip on its way out already is only to come out less far.
  const double out = stops > least_ + kTipUnheld ? stops : 0.0;
  const double here = std::max(off(state_.X_ST.p), out);
  if (off(p) > std::max(least_ + kTipUnheld, here)) return true;
  double least = std::min(least_, off(p));
  for (int k = trial_.next; k < trial_.size; ++k) {
    const double now = off(tip_at(trial_.q[static_cast<std::size_t>(k)]));
    least = std::min(least, now);
    const double most = std::max(least + kTipUnheld, out);
    if (now > (k + 1 < trial_.size ? std::max(most, here) : most)) return true;
  }
  return false;
}

bool TipPlanner::passes(const TipMotion& next) const noexcept {
  const Vec3 way = p_goal_ - state_.X_ST.p;
  const Vec3& step = next.tip_step.linear;
  // A slow tip that turns may waver about its place.
  if (trial_.size == 0 || step.norm() < kTipSlow * settings_.dt) return false;
  if (way.dot(step) < kAhead * way.norm() * step.norm()) return false;
  const double held = space_.freedom() < 3 ? kPasses : kPassesFree;
  const double most = std::max(beside_, held);
  return (end_of(trial_, next.X_ST.p) - p_goal_).dot(way) > most * way.norm();
}

}  // namespace handrail
