// Moving the tip toward a target pose within the arm's limits, always able to
// stop on the tool.
//
// A step is taken only together with a stop plan: the joint commands from it to
// rest, on the tool, each of which the guard was asked about. Holding, stopping
// and a bad command play the plan. The rest of a plan is a plan, so there
// always is one.
#pragma once

#include <optional>

#include "server/base/joints.h"
#include "server/base/spatial.h"
#include "server/model/reason.h"
#include "server/model/tip_space.h"
#include "server/motion/guard.h"
#include "server/motion/stop_plan.h"

namespace handrail {

struct MotionSettings {
  ArmGeometry arm;
  JointLimits limits;
  Workspace workspace;
  double tip_speed = 1.0;  // [m/s]
  double dt = 0.0071;      // controller cycle [s]

  GuardLimits guard() const noexcept { return {limits, arm, workspace, dt}; }
};

// The newest target.
struct TipTarget {
  Pose X;
  Vec3 p_gone_to = Vec3::Zero();  // the place gone to for it [m]
  bool beyond = false;            // it is out of reach
  double least = 0.0;             // the nearest that the tip was to it while it stands [m]
};

struct MotionState : TipMotion {
  StopPlan stop;
  int sliding = 0;  // > 0: past where the straight way ends; so many straight steps end it
  int around = 0;   // > 0: the joints go round what is in the way, so many cycles more
  std::optional<TipTarget> asked;
};

// Stands still at `q`.
MotionState standing_at(const ArmGeometry& arm, const JointVector& q) noexcept;

// What a cycle came to.
struct Moved {
  Vec3 p_goal = Vec3::Zero();  // the place gone to: the target's, or the nearest in reach [m]
  Verdict reach;               // what keeps it from being the target; kNone: nothing
  Verdict limit;               // what slows the way there
};

// One cycle toward `target` within `space`; a tip outside of it goes straight to the target. As far
// as joint range, speed, acceleration and jerk allow, and slow enough to stop on the target. Out of
// reach the nearest reachable pose is gone to (nearest_reachable); beyond the workspace the nearest
// place 5 mm inside. From a target that stands the tip goes no further than it was, nor in a stop.
// Where the straight way does not fit the joints, as near singular poses, the tip is slowed, then
// goes on by what the joints can do: it keeps its place, and its orientation lags. `share` 0..1
// slows the approach. Real-time safe, at most 15 stop plans, mostly one.
Moved move_toward(const MotionSettings& settings, const TipSpace& space, const Pose& target,
                  double share, MotionState& state) noexcept;

// One cycle of the stop plan; at rest it holds.
void brake(const MotionSettings& settings, MotionState& state) noexcept;

// Sends the newest command through the guard; `before` is where the commands
// stood before it. When the guard does not let it pass, `state` becomes what
// the guard sends instead. Real-time safe.
Verdict pass_guard(const MotionSettings& settings, const GuardState& before,
                   MotionState& state) noexcept;

// True when the arm is commanded to rest.
inline bool standing(const MotionState& state) noexcept {
  return state.joints.step.isZero(0.0) && state.joints.change.isZero(0.0);
}

}  // namespace handrail
