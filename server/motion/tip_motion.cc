#include "server/motion/tip_motion.h"

#include <algorithm>
#include <cmath>

#include "server/base/deletable.h"
#include "server/kinematics/reach.h"
#include "server/motion/joint_step.h"
#include "server/motion/step_chooser.h"
#include "server/motion/tip_law.h"

namespace handrail {
namespace {

// `space` as it holds now: without its room once the tip and its target are on the point, line or
// plane itself, on the tip's side of it while it is off it and its target is not on the other;
// everything while the tip is further off than the room.
TipSpace space_now(const TipSpace& space, const Vec3& p_target, const TipMotion& m) {
  const double off = space.distance(m.X_ST.p);
  if (off > space.room + kTiny.on) return {};
  TipSpace now = space;
  const Vec3 target = space.off(p_target);
  if (off < kTiny.on && target.norm() < kTiny.on) now.room = 0.0;
  // What is to come nearer does not come to the other side.
  const Vec3 side = space.off(m.X_ST.p) / off;
  if (off >= kTiny.on && target.dot(side) > -kTiny.on) now.side_S = side;
  return now;
}

// The nearest to `p` that is far enough inside to move along the workspace's faces, or as far as
// the tip is now.
Vec3 inside(const Workspace& workspace, const Vec3& p, const Vec3& tip) {
  const Vec3 margin = Vec3::Constant(kMotion.from_face);
  const Vec3 low = (workspace.low + margin).cwiseMin(tip);
  const Vec3 high = (workspace.high - margin).cwiseMax(tip);
  return p.cwiseMax(low).cwiseMin(high);
}

// Why the place or the turn asked for is not gone to.
Verdict beyond_reach(const ArmGeometry& arm, const Vec3& p_target, const Reached& reached) {
  if (reached.joint < 0) return {};
  // Where the wrist would be too near to the shoulder it is a joint that ends.
  const Vec3 to_tip = arm.wrist_to_tip(reached.X.q);
  const auto off_shoulder = [&](const Vec3& p_wrist) {
    return std::hypot(p_wrist.head<2>().norm() - arm.a1, p_wrist.z() - arm.d1);
  };
  const bool further = off_shoulder(p_target - to_tip) > off_shoulder(reached.X.p - to_tip);
  const bool stretched = reached.arm && reached.joint == 2 && further;
  return {stretched ? Reason::kOutOfReach : Reason::kJointRange, reached.joint};
}

// One cycle of the stop plan.
TipMotion play(const PlanLimits& limits, MotionState& state) {
  if (state.stop.done()) return after(limits, state, state.joints.q, state.X_ST);
  const JointVector& q = state.stop.q[static_cast<std::size_t>(state.stop.next++)];
  return after(limits, state, q, q == state.joints.q ? state.X_ST : forward(limits.guard.arm, q));
}

const JointVector& rest_joints(const MotionState& state) {
  const StopPlan& stop = state.stop;
  return stop.done() ? state.joints.q : stop.q[static_cast<std::size_t>(stop.size - 1)];
}

// Of a way in place and turn [m].
double size_of(const Twist& way) {
  return way.linear.norm() + kMotion.turn_length * way.angular.norm();
}

// Where the arm goes for `target`, which was asked for at `asked`. It is looked for from where the
// arm comes to rest. One out of reach that stands is looked for from where it was found last, as
// long as that brings it nearer: beside a singular pose places far apart are as near to it, and an
// arm that went after another one in each cycle would not come to rest.
Reached gone_to(const ArmMotion& motion, const TipSpace& space, const Pose& target,
                const Pose& asked, const MotionState& state) {
  const ArmGeometry& arm = motion->arm;
  const bool stands =
      state.asked && state.asked->beyond && size_of(between(state.asked->X, asked)) < kTiny.found;
  const JointVector& from = stands ? state.asked->q : rest_joints(state);
  Reached found =
      nearest_reachable(arm, motion->limits, space, target, from, motion.limits().from_end);
  if (!stands || found.joint < 0) return found;
  const Pose before = forward(arm, from);
  if (size_of(between(before, target)) - size_of(between(found.X, target)) < kTiny.waver) {
    found.q = from;
    found.X = before;
  }
  return found;
}

// What a step and its stop toward `p_goal` have to keep, for a target asked for at `asked` that is
// looked for at `p_target`.
Ends ends_of(const MotionSettings& settings, const TipSpace& space, const Pose& asked,
             const Vec3& p_target, const Vec3& p_goal, bool in_reach, const MotionState& state) {
  const bool held = space.freedom() < 3 || space.touched;
  Ends ends;
  ends.p_goal = p_goal;
  ends.past = held ? kTiny.past : kMotion.unheld;
  ends.slow = kMotion.slow * settings.dt;
  ends.p_target = p_target;
  ends.least = (state.X_ST.p - p_target).norm();
  if (!state.asked || !kept(Check::kStay)) return ends;
  const Twist went = between(state.asked->X, asked);
  ends.stays = size_of(went) < ends.slow || !in_reach;
  if (!ends.stays) return ends;
  // A target that moves on may be left as far as it goes itself; one out of reach, also as far as
  // its turn takes along the place in reach.
  const double by =
      went.linear.norm() + (in_reach ? 0.0 : settings.arm.tip_radius() * went.angular.norm());
  ends.least = std::min(ends.least, state.asked->least + by);
  // A tip on its way out already is only to come out less far.
  const double stops = (rest_place(state) - p_target).norm();
  if (stops > ends.least + kMotion.unheld) ends.out = stops;
  return ends;
}

// Whether a tip on its way out would brake less by a step to `p_next` than by its plan, which is
// then all that may be taken.
bool brakes_less(const TipJacobian& J, const Ends& ends, const Vec3& p_next,
                 const MotionState& state) {
  if (ends.out <= 0.0 || state.stop.done()) return false;
  const StopPlan& plan = state.stop;
  const JointVector by = plan.q[static_cast<std::size_t>(plan.next)] - state.joints.q;
  const Vec3& p = state.X_ST.p;
  return (p_next - p - J.linear * by).dot(p - ends.p_target) > 0.0;
}

}  // namespace

MotionState standing_at(const ArmGeometry& arm, const JointVector& q) noexcept {
  MotionState state;
  state.joints.q = q;
  state.X_ST = forward(arm, q);
  return state;
}

Moved move_toward(const ArmMotion& motion, const TipSpace& space, const Pose& asked, double share,
                  MotionState& state) noexcept {
  const MotionSettings& settings = motion.settings();
  const PlanLimits& limits = motion.limits();
  const ArmGeometry& arm = settings.arm;
  const Pose target{inside(settings.workspace, asked.p, state.X_ST.p), asked.q};
  const TipSpace within = space_now(space, target.p, state);
  const Reached reached =
      gone_to(motion, within, {within.nearest(target.p), target.q}, asked, state);
  const bool in_reach = reached.joint < 0;
  const Pose goal{within.nearest(reached.X.p), reached.X.q};
  const Ends ends = ends_of(settings, within, asked, target.p, goal.p, in_reach, state);
  state.asked = TipTarget{asked, !in_reach, ends.least, reached.q};
  Moved moved{state, goal.p, beyond_reach(arm, target.p, reached), {}};
  if (in_reach && target.p != asked.p) moved.reach = {Reason::kWorkspace, -1};

  const TipPlace tip_now(arm, state.joints.q);
  const TipJacobian J = tip_now.jacobian();
  const TipLaw law{settings.tip_speed, settings.dt, share, ends.past};
  const TipProposal proposal(limits, within, law, J, state, goal);
  const Twist way = proposal.way();
  const Twist step = proposal.step();
  const Vec3 p_next = within.nearest(state.X_ST.p + step.linear);
  const bool found = !in_reach && size_of(way) < kTiny.found;
  const bool there = step.angular.isZero(0.0) && (p_next - state.X_ST.p).norm() < kTiny.off;
  if (found || there || brakes_less(J, ends, p_next, state)) {
    moved.next = play(limits, state);
    return moved;
  }
  const Pose X{p_next, (rotation_exp(step.angular) * state.X_ST.q).normalized()};
  PlaceInverse inverse(limits);
  JointVector q;
  const bool straight = solve_near(arm, X, state.joints.q, q) && in_box(limits, state.joints, q);
  Pose X_next = X;
  if (!straight) {
    const StepBox box(limits, state.joints);
    const JointVector own = own_steps(limits, state.joints, reached.q, share);
    q = state.joints.q + step_in_box(limits, box, J.linear, state.joints.q, X.p, own);
    if (!within.everything()) {
      TipPlace tip(arm, q);
      inverse.bring_to(within.nearest(tip.p()), tip, q);
    }
    X_next = forward(arm, q);
  }
  StepChooser chooser(limits, within, ends, tip_now, state);
  const bool taken = chooser.take_most(q, X_next, inverse, moved.next);
  if (!taken) moved.next = play(limits, state);
  const bool by_law = taken || chooser.refused().reason == Reason::kNone;
  const Verdict limiting = by_law ? proposal.limiting() : chooser.refused();
  if (taken && straight) {
    if (size_of(way) > kMotion.unheld) moved.limit = limiting;
  } else {
    moved.limit = near_singular(arm, state.joints.q) ? Verdict{Reason::kSingularity, -1} : limiting;
  }
  return moved;
}

TipMotion brake(const ArmMotion& motion, MotionState& state) noexcept {
  return play(motion.limits(), state);
}

Verdict command(const ArmMotion& motion, const TipMotion& decided, MotionState& state) noexcept {
  GuardState sent = state.joints;
  const Verdict verdict = guard(motion.limits().guard, sent, decided.joints.q);
  if (verdict.reason == Reason::kNone) {
    static_cast<TipMotion&>(state) = decided;
  } else {
    // No plan starts here: the joints stop each by its own law until they stand.
    const Twist before = state.tip_step;
    const Pose X_last = state.X_ST;
    state.X_ST = forward(motion->arm, sent.q);
    state.tip_step = between(X_last, state.X_ST);
    state.tip_change = state.tip_step - before;
    state.stop = StopPlan();
  }
  state.joints = sent;
  return verdict;
}

}  // namespace handrail
