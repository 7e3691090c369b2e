// The steps that the tip may take: each only together with a stop plan.
#pragma once

#include <optional>

#include "server/motion/tip_motion.h"

namespace handrail {

inline constexpr double kTipSlow = 0.02;  // a tip that moves less is as good as standing [m/s]
inline constexpr double kTipLever = 0.1;  // the arm's length at which a turn counts as speed [m]
// Where no tool holds the tip: past its goal, and beside its way [m].
inline constexpr double kTipUnheld = 2e-3;

// Steps of the tip to choose from.
struct Ways {
  Twist wanted, gentle;  // with all, and with little of what the joints can do
  Twist stop;
};

// One cycle of the stop plan, or standing. Real-time safe.
void play(const PlanLimits& limits, MotionState& state) noexcept;

// Whether the stop is over in two cycles: the arm is all but at rest.
inline bool ends(const StopPlan& stop) noexcept { return stop.next + 2 >= stop.size; }

// Tries steps for one cycle. The first that the joints can do, and can stop after, becomes the
// newest command in `state`; every other changes nothing there but what is counted. Real-time safe,
// a stop plan each.
class TipPlanner {
 public:
  // `free`: neither tool nor contact holds the tip, now or later.
  TipPlanner(const MotionSettings& settings, const TipSpace& space, bool free,
             MotionState& state) noexcept
      : settings_(settings),
        limits_(settings.guard()),
        space_(space),
        beside_(free ? kTipUnheld : 0.0),
        state_(state) {}

  void set_goal(const Vec3& p) noexcept { p_goal_ = p; }
  // From here on no step, nor its stop, takes the tip more than kTipUnheld further from p than
  // `least` [m], the nearest it was, or than it is by then. A tip further out already goes no
  // further out than it is, and stops no further out than it would.
  void stay_near(const Vec3& p, double least) noexcept {
    p_stay_ = p;
    least_ = least;
  }
  const PlanLimits& limits() const noexcept { return limits_; }
  const Verdict& refused() const noexcept { return refused_; }

  // Takes the straight step if the joints can and could stop after it.
  bool straight(const Twist& step) noexcept;

  // What the stop would do now.
  Twist next_of_stop() const noexcept;

  // The straight way with less of everything, down to little more than the stop.
  bool slower(const Ways& ways, const Twist& first, const Twist& second) noexcept;

  // By the joints' own way: the tip keeps its place and way while its turn lags. Where that does
  // not lead on, nothing holds the tip and it is `stuck`, the joints go round. They begin at rest:
  // what moves them then would take the tip anywhere. And not where that is a way nobody would
  // expect: there the arm waits for the hand to lead on.
  bool otherwise(const Ways& ways, const JointVector& there, double speed, bool stuck) noexcept;

  // The joints' own way wherever the tip goes, but with `from` not away from there.
  bool by_joints(const JointVector& there, double speed, double beside,
                 const Vec3* from = nullptr) noexcept;

 private:
  // The joints' own way, the tip at p.
  bool sliding(const JointVector& there, const Vec3& p, double speed) noexcept;
  bool take(const JointVector& q, const Pose& X, double beside) noexcept;
  bool refuse(const Verdict& why) noexcept;
  // Whether a step to p, or the trial stop after it, leaves the place to stay near.
  bool leaves(const Vec3& p) const noexcept;
  // Whether the stop from `next` ends beyond the goal that lies ahead.
  bool passes(const TipMotion& next) const noexcept;
  Vec3 tip_at(const JointVector& q) const noexcept { return forward(limits_.guard.arm, q).p; }
  // Where `stop` brings a tip to rest that is at p.
  Vec3 end_of(const StopPlan& stop, const Vec3& p) const noexcept {
    return stop.done() ? p : tip_at(stop.q[static_cast<std::size_t>(stop.size - 1)]);
  }

  const MotionSettings& settings_;
  Vec3 p_goal_ = Vec3::Zero();
  std::optional<Vec3> p_stay_;  // no step leads further from it [m]
  double least_ = 0.0;          // than so far [m]
  PlanLimits limits_;
  const TipSpace& space_;
  const double beside_;  // how far a stop may end beside the tip's way or past its goal
  MotionState& state_;
  StopPlan trial_;
  Verdict refused_;  // why the first proposal was
};

}  // namespace handrail
