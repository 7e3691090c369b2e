#include "server/control/tip_motion.h"

#include <algorithm>
#include <cmath>

#include "server/base/deletable.h"
#include "server/control/slide.h"
#include "server/control/tip_law.h"
#include "server/kinematics/reach.h"

namespace handrail {
namespace {

constexpr double kFromFace = 5e-3;   // of the workspace [m]
constexpr double kArrived = 1e-12;   // [m], [rad]: below rounding
constexpr double kFound = 2e-8;      // what a search for the end of reach leaves [m], [rad]
constexpr double kOnSpace = 5e-6;    // further off a tip is not on its space [m]
constexpr double kSlow = 0.02;       // a tip that moves less is as good as standing [m/s]
constexpr double kStanding = 0.002;  // [m/s]
constexpr double kLever = 0.1;
constexpr int kAround = 70;  // cycles
// With 0.05 an arm that turns through a straight wrist waits there for the hand; with 0.12 one
// whose wrist unwinds takes the tip as far away from a hand that stands [m].
constexpr double kDetourMost = 0.085;
constexpr double kGoing = 1e-5;       // slower is standing [rad]
constexpr double kNearly = 1e-2;      // [rad]
constexpr int kStraightAgain = 15;    // straight steps in a row end a slide
constexpr double kDetour = 2.5;       // so many times longer the straight way is none
constexpr double kSoon = 15.0;        // cycles
constexpr double kAhead = 0.95;       // cosine: the tip moves toward its goal
constexpr double kPasses = 1e-7;      // [m]
constexpr double kPassesFree = 1e-4;  // off its tool [m]
constexpr double kUnheld =
    2e-3;  // where no tool holds the tip: past its goal, and beside its way [m]
constexpr double kAnywhere = 1e9;       // [m]
constexpr double kGoesBack = 1e-12;     // [m]
constexpr double kBehind = 1e-3;        // less to go is not worth a reason [m]
constexpr double kTurnBehind = 1e-2;    // [rad]
constexpr double kNearWrist = 0.05;     // |sin J5|
constexpr double kNearShoulder = 0.02;  // [m]
constexpr double kShare = 0.88;         // of the joints' acceleration and jerk, for a straight step
constexpr double kShareAtEnd = 0.7;     // where the joints' share of a straight step changes much
constexpr double kHardest = 0.915;      // for braking: a little less than a stop plan's

Twist operator+(const Twist& a, const Twist& b) {
  return {a.linear + b.linear, a.angular + b.angular};
}
Twist operator-(const Twist& a, const Twist& b) {
  return {a.linear - b.linear, a.angular - b.angular};
}
Twist operator*(double s, const Twist& t) { return {s * t.linear, s * t.angular}; }

Twist between(const Pose& from, const Pose& to) {
  return {to.p - from.p, rotation_log(to.q * from.q.conjugate())};
}

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

// One cycle of the stop plan, or standing.
void play(const PlanLimits& limits, MotionState& state) {
  JointVector q = state.joints.q;
  if (!state.stop.done()) q = state.stop.q[static_cast<std::size_t>(state.stop.next++)];
  const bool same = q == state.joints.q;
  move_to(limits, q, same ? state.X_ST : forward(limits.guard.arm, q), state);
}

// Whether the stop is over in two cycles: the arm is all but at rest.
bool ends(const StopPlan& stop) { return stop.next + 2 >= stop.size; }

// Steps of the tip to choose from.
struct Ways {
  Twist wanted, gentle;  // with all, and with little of what the joints can do
  Twist stop;
};

class Planner {
 public:
  // `free`: neither tool nor contact holds the tip, now or later.
  Planner(const MotionSettings& settings, const TipSpace& space, bool free, MotionState& state)
      : settings_(settings),
        limits_(settings.guard()),
        space_(space),
        beside_(free ? kUnheld : 0.0),
        state_(state) {}

  void set_goal(const Vec3& p) { p_goal_ = p; }
  // From here on no step, nor its stop, takes the tip further from p than it is, or its goal.
  void stay_near(const Vec3& p) { p_stay_ = p; }
  const PlanLimits& limits() const { return limits_; }
  const Verdict& refused() const { return refused_; }

  // Takes the straight step if the joints can and could stop after it.
  bool straight(const Twist& step) {
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

  // What the stop would do now.
  Twist next_of_stop() const {
    if (state_.stop.done()) return {};
    const JointVector& q = state_.stop.q[static_cast<std::size_t>(state_.stop.next)];
    return between(state_.X_ST, forward(limits_.guard.arm, q));
  }

  // The straight way with less of everything, down to little more than the stop.
  bool slower(const Ways& ways, const Twist& first, const Twist& second) {
    const Twist more = ways.gentle - ways.stop;
    for (const Twist& step :
         {first, second, ways.gentle, ways.stop + 0.6 * more, ways.stop + 0.3 * more}) {
      const bool going = step.linear.norm() + kLever * step.angular.norm() > kGoing * kLever;
      if (going && straight(step)) return true;
    }
    return false;
  }

  // By the joints' own way: the tip keeps its place and way while its turn lags. Where that does
  // not lead on, nothing holds the tip and it is `stuck`, the joints go round. They begin at rest:
  // what moves them then would take the tip anywhere. And not where that is a way nobody would
  // expect: there the arm waits for the hand to lead on.
  bool otherwise(const Ways& ways, const JointVector& there, double speed, bool stuck) {
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

  // The joints' own way wherever the tip goes, but with `from` not away from there.
  bool by_joints(const JointVector& there, double speed, double beside,
                 const Vec3* from = nullptr) {
    const JointVector q = own_way(limits_, state_.joints, there, speed);
    const Pose X = forward(limits_.guard.arm, q);
    if (from != nullptr && (X.p - *from).norm() > (state_.X_ST.p - *from).norm()) return false;
    return (X.p - state_.X_ST.p).norm() <= settings_.tip_speed * settings_.dt && take(q, X, beside);
  }

 private:
  // The joints' own way, the tip at p.
  bool sliding(const JointVector& there, const Vec3& p, double speed) {
    JointVector q;
    if (!slide(limits_, space_, state_, there, p, speed, q)) {
      return refuse({Reason::kOutOfReach, -1});
    }
    const bool going = (q - state_.joints.q).cwiseAbs().maxCoeff() > kGoing ||
                       (there - q).cwiseAbs().maxCoeff() < kNearly;
    return going && take(q, forward(limits_.guard.arm, q), beside_);
  }

  bool refuse(const Verdict& why) {
    if (refused_.reason == Reason::kNone) refused_ = why;
    return false;
  }

  bool take(const JointVector& q, const Pose& X, double beside) {
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
    if (p_stay_ && (leaves(X.p) || leaves(end_of_stop(next)))) {
      return refuse({Reason::kOutOfReach, -1});
    }
    static_cast<TipMotion&>(state_) = next;
    state_.stop = trial_;
    return true;
  }

  // Where the tip comes to rest that stops from `next`.
  Vec3 end_of_stop(const TipMotion& next) const {
    if (trial_.size == 0) return next.X_ST.p;
    return forward(limits_.guard.arm, trial_.q[static_cast<std::size_t>(trial_.size - 1)]).p;
  }

  bool leaves(const Vec3& p) const {
    const auto off = [&](const Vec3& place) { return (place - *p_stay_).norm(); };
    return off(p) > std::max(off(state_.X_ST.p), off(p_goal_) + kUnheld);
  }

  // Whether the stop from `next` ends beyond the goal that lies ahead.
  bool passes(const TipMotion& next) const {
    const Vec3 way = p_goal_ - state_.X_ST.p;
    const Vec3& step = next.tip_step.linear;
    // A slow tip that turns may waver about its place.
    if (trial_.size == 0 || step.norm() < kSlow * settings_.dt) return false;
    if (way.dot(step) < kAhead * way.norm() * step.norm()) return false;
    const double held = space_.freedom() < 3 ? kPasses : kPassesFree;
    const double most = std::max(beside_, held);
    return (end_of_stop(next) - p_goal_).dot(way) > most * way.norm();
  }

  const MotionSettings& settings_;
  Vec3 p_goal_ = Vec3::Zero();
  std::optional<Vec3> p_stay_;  // no step leads further from it [m]
  PlanLimits limits_;
  const TipSpace& space_;
  const double beside_;  // how far a stop may end beside the tip's way or past its goal
  MotionState& state_;
  StopPlan trial_;
  Verdict refused_;  // why the first proposal was
};

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

// Of the tip, with what turns at an arm's length of kLever [m].
double tip_speed(const TipMotion& m) {
  return m.tip_step.linear.norm() + kLever * m.tip_step.angular.norm();
}

// Whether a target that was at `before` a cycle of dt [s] ago is as good as standing.
bool standing_since(const Pose& before, const Pose& now, double dt) {
  const Twist way = between(before, now);
  return way.linear.norm() + kLever * way.angular.norm() < kSlow * dt;
}

// True for what the straight way runs into; false for what only slows it.
bool blocked(Reason why) {
  return why == Reason::kSingularity || why == Reason::kJointRange || why == Reason::kOutOfReach ||
         why == Reason::kWorkspace;
}

bool near_singular(const ArmGeometry& arm, const JointVector& q) {
  const SingularityMargin margin = singularity_margin(arm, q);
  return margin.wrist < kNearWrist || margin.shoulder < kNearShoulder;
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
  Planner planner(settings, within, free, state);
  // The place gone to for a target out of reach is looked for from where the tip is: it would move
  // away as the tip turns. A hand that moves on leads out of what holds the tip there.
  const bool stands =
      state.beyond && kept(Check::kStay) && standing_since(state.beyond->asked, asked, settings.dt);
  const Reached reached = nearest_reachable(
      settings.arm, settings.limits, within, {within.nearest(target.p), target.q}, state.joints.q,
      planner.limits().from_end, stands ? &state.beyond->p : nullptr);
  const Pose goal{within.nearest(reached.X.p), reached.X.q};
  planner.set_goal(goal.p);
  const bool in_reach = reached.joint < 0;
  state.beyond = in_reach ? std::nullopt : std::optional(BeyondReach{asked, reached.X.p});
  if (!in_reach && stands) planner.stay_near(target.p);
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
  if (free && reached.arm && planner.by_joints(reached.q, share, kUnheld, &target.p)) return moved;
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
  if (waits && !stuck && planner.by_joints(reached.q, share, kUnheld)) return moved;
  const bool slow = tip_speed(state) < (stuck ? kSlow : kStanding) * settings.dt;
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
