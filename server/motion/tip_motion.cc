#include "server/motion/tip_motion.h"

#include <algorithm>
#include <cmath>

#include "server/base/deletable.h"
#include "server/kinematics/reach.h"
#include "server/motion/slide.h"
#include "server/motion/tip_law.h"
#include "server/motion/tip_planner.h"

namespace handrail {
namespace {

constexpr double kFromFace = 5e-3;       // of the workspace [m]
constexpr double kArrived = 1e-12;       // [m], [rad]: below rounding
constexpr double kFound = 2e-8;          // what a search for the end of reach leaves [m], [rad]
constexpr double kOnSpace = 5e-6;        // further off a tip is not on its space [m]
constexpr double kStanding = 0.002;      // [m/s]
constexpr double kDetour = 2.5;          // so many times longer the straight way is none
constexpr double kSoon = 15.0;           // cycles
constexpr double kBehind = 1e-3;         // less to go is not worth a reason [m]
constexpr double kTurnBehind = 1e-2;     // [rad]
constexpr double kStraightWrist = 0.05;  // |sin J5|
constexpr double kNearShoulder = 0.02;   // [m]
constexpr double kShare = 0.88;      // of the joints' acceleration and jerk, for a straight step
constexpr double kShareAtEnd = 0.7;  // where the joints' share of a straight step changes much
constexpr double kHardest = 0.915;   // for braking: a little less than a stop plan's

// `space` as it holds now: without its room once the tip and its target are on the point, line or
// plane itself, on the tip's side of it while it is off it and its target is not on the other;
// everything while the tip is further off than the room.
TipSpace space_now(const TipSpace& space, const Vec3& p_target, const TipMotion& m) {
  const double off = space.distance(m.X_ST.p);
  if (off > space.room + kOnSpace) return {};
  TipSpace now = space;
  const Vec3 target = space.off(p_target);
  if (off < kOnSpace && target.norm() < kOnSpace) now.room = 0.0;
  // What is to come nearer does not come to the other side.
  const Vec3 side = space.off(m.X_ST.p) / off;
  if (off >= kOnSpace && target.dot(side) > -kOnSpace) now.side_S = side;
  return now;
}

// The nearest to `p` that is far enough inside to move along the workspace's faces, or as far as
// the tip is now.
Vec3 inside(const Workspace& workspace, const Vec3& p, const Vec3& tip) {
  const Vec3 margin = Vec3::Constant(kFromFace);
  const Vec3 low = (workspace.low + margin).cwiseMin(tip);
  const Vec3 high = (workspace.high - margin).cwiseMax(tip);
  return p.cwiseMax(low).cwiseMin(high);
}

// Why the place or the turn asked for is not gone to.
Verdict beyond_reach(const Reached& reached) {
  if (reached.joint < 0) return {};
  const bool stretched = reached.arm && reached.joint == 2;
  return {stretched ? Reason::kOutOfReach : Reason::kJointRange, reached.joint};
}

// Of the tip, with what turns at an arm's length of kTipLever [m].
double tip_speed(const TipMotion& m) {
  return m.tip_step.linear.norm() + kTipLever * m.tip_step.angular.norm();
}

// Whether a target that was at `before` a cycle of dt [s] ago is as good as standing.
bool standing_since(const Pose& before, const Pose& now, double dt) {
  const Twist way = between(before, now);
  return way.linear.norm() + kTipLever * way.angular.norm() < kTipSlow * dt;
}

// True for what the straight way runs into; false for what only slows it.
bool blocked(Reason why) {
  return why == Reason::kSingularity || why == Reason::kJointRange || why == Reason::kOutOfReach ||
         why == Reason::kWorkspace;
}

bool near_singular(const ArmGeometry& arm, const JointVector& q) {
  const SingularityMargin margin = singularity_margin(arm, q);
  return margin.wrist < kStraightWrist || margin.shoulder < kNearShoulder;
}

}  // namespace

MotionState standing_at(const ArmGeometry& arm, const JointVector& q) noexcept {
  MotionState state;
  state.joints.q = q;
  state.X_ST = forward(arm, q);
  return state;
}

Moved move_toward(const MotionSettings& settings, const TipSpace& space, const Pose& asked,
                  double share, MotionState& state) noexcept {
  const Pose target{inside(settings.workspace, asked.p, state.X_ST.p), asked.q};
  const TipSpace within = space_now(space, target.p, state);
  const bool free = space.everything() && !space.touched;
  TipPlanner planner(settings, within, free, state);
  // The place gone to for a target out of reach is looked for from where the tip is: it would move
  // away as the tip turns. A hand that moves on leads out of what holds the tip there.
  const bool stands =
      state.asked && kept(Check::kStay) && standing_since(state.asked->X, asked, settings.dt);
  const Reached reached = nearest_reachable(
      settings.arm, settings.limits, within, {within.nearest(target.p), target.q}, state.joints.q,
      planner.limits().from_end, stands && state.asked->beyond ? &state.asked->p_gone_to : nullptr);
  const Pose goal{within.nearest(reached.X.p), reached.X.q};
  planner.set_goal(goal.p);
  const bool in_reach = reached.joint < 0;
  const double off = (state.X_ST.p - target.p).norm();
  // A target that moves on may be left as far as it goes itself; one out of reach, also as far as
  // its turn takes along the place in reach.
  const bool stays = state.asked && kept(Check::kStay) && (stands || !in_reach);
  double least = off;
  if (stays) {
    const Twist way = between(state.asked->X, asked);
    const double went = way.linear.norm() + (in_reach ? 0.0 : settings.arm.d6 * way.angular.norm());
    least = std::min(off, state.asked->least + went);
    planner.stay_near(target.p, least);
  }
  state.asked = TipTarget{asked, reached.X.p, !in_reach, least};
  Moved moved{goal.p, beyond_reach(reached), {}};
  if (in_reach && target.p != asked.p) moved.reach = {Reason::kWorkspace, -1};

  const TipProposal proposal(planner.limits(), within, {settings.tip_speed, settings.dt, share},
                             state, goal);
  const Twist way = proposal.way();
  const double arrived = in_reach ? kArrived : kFound;
  if (way.linear.norm() < arrived && way.angular.norm() < arrived) {
    play(planner.limits(), state);
    return moved;
  }

  const double most = in_reach ? kShare : kShareAtEnd;
  const Twist wanted = state.tip_step + proposal.change(most, most, kHardest / most);
  const bool direct =
      proposal.cycles() < kDetour * own_cycles(planner.limits(), state.joints.q, reached.q) + kSoon;
  if (direct && planner.straight(wanted)) {
    state.sliding = std::max(0, state.sliding - 1);
    const bool behind = way.linear.norm() > kBehind || way.angular.norm() > kTurnBehind;
    if (behind) moved.limit = proposal.limiting();
    return moved;
  }
  // Along the end of reach, which bends, the joints' own way keeps the one that ends there. Before
  // it that way may begin with a detour.
  if (free && reached.arm && planner.by_joints(reached.q, share, kTipUnheld, &target.p))
    return moved;
  const bool singular = !direct || near_singular(settings.arm, state.joints.q);
  moved.limit = singular ? Verdict{Reason::kSingularity, -1} : planner.refused();
  const Ways ways{wanted,
                  state.tip_step + proposal.change(0.35 * kShare, 0.15 * kShare, 1.0, false),
                  planner.next_of_stop()};
  // Joints that go their own ways bend the tip's. Where only their limits are in the way, and no
  // end of reach, the tip comes back to the straight way by going slower.
  const bool stuck = blocked(moved.limit.reason);
  if (direct && (state.sliding == 0 || !stuck)) {
    const double hard = kHardest / most;
    const auto with = [&](double place, double turn) {
      return state.tip_step + proposal.change(place, turn, hard, false);
    };
    if (planner.straight(with(most, most)) ||
        planner.slower(ways, with(0.75 * kShare, 0.22 * kShare),
                       with(0.5 * kShare, 0.35 * kShare))) {
      return moved;
    }
  }
  // Slowed into first, then slid along; and before the stop ends, so that the arm never waits.
  const bool waits = free && ends(state.stop);
  if (waits && !stuck && planner.by_joints(reached.q, share, kTipUnheld)) return moved;
  const bool slow = tip_speed(state) < (stuck ? kTipSlow : kStanding) * settings.dt;
  const bool slides = state.sliding > 0 || slow || waits;
  if (!slides || !planner.otherwise(ways, reached.q, share, stuck)) play(planner.limits(), state);
  return moved;
}

void brake(const MotionSettings& settings, MotionState& state) noexcept {
  play(PlanLimits(settings.guard()), state);
}

Verdict pass_guard(const MotionSettings& settings, const GuardState& before,
                   MotionState& state) noexcept {
  const GuardLimits limits = settings.guard();
  GuardState sent = before;
  const Verdict verdict = guard(limits, sent, state.joints.q);
  if (verdict.reason != Reason::kNone) {
    // No plan starts here: the joints stop each by its own law until they
    // stand.
    const Pose X_first = forward(settings.arm, before.q - before.step);
    const Pose X_last = forward(settings.arm, before.q);
    state.X_ST = forward(settings.arm, sent.q);
    state.tip_step = between(X_last, state.X_ST);
    state.tip_change = state.tip_step - between(X_first, X_last);
    state.stop = StopPlan();
  }
  state.joints = sent;
  return verdict;
}

}  // namespace handrail
