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
#include "server/model/rv2a_limits.h"
#include "server/model/tip_space.h"
#include "server/motion/guard.h"
#include "server/motion/stop_plan.h"

namespace handrail {

struct MotionSettings {
  ArmGeometry arm;
  JointLimits limits = rv2a_limits();
  Workspace workspace;
  double tip_speed = 1.0;  // [m/s]
  double dt = 0.0071;      // controller cycle [s]
};

// The settings, and the limits that are worked out of them once.
class ArmMotion {
 public:
  ArmMotion(const MotionSettings& settings = {}) noexcept
      : settings_(settings),
        limits_({settings.limits, settings.arm, settings.workspace, settings.dt}) {}
  const MotionSettings* operator->() const noexcept { return &settings_; }
  const MotionSettings& settings() const noexcept { return settings_; }
  const PlanLimits& limits() const noexcept { return limits_; }

 private:
  MotionSettings settings_;
  PlanLimits limits_;
};

// The newest target.
struct TipTarget {
  Pose X;
  bool beyond = false;                  // it is out of reach
  double least = 0.0;                   // the nearest that the tip was to it while it stands [m]
  JointVector q = JointVector::Zero();  // that bring the tip to it, or to the nearest place [rad]
};

struct MotionState : TipMotion {
  StopPlan stop;  // from the step that was decided last
  std::optional<TipTarget> asked;
};

// Stands still at `q`.
MotionState standing_at(const ArmGeometry& arm, const JointVector& q) noexcept;

// What a cycle came to.
struct Moved {
  TipMotion next;              // to be commanded
  Vec3 p_goal = Vec3::Zero();  // the place gone to: the target's, or the nearest in reach [m]
  Verdict reach;               // what keeps it from being the target; kNone: nothing
  Verdict limit;               // what slows the way there
};

// Decides one cycle toward `target` within `space`; a tip outside of it goes straight to the
// target. As far as joint range, speed, acceleration and jerk allow, and slow enough to stop on the
// target. Out of reach the nearest reachable pose is gone to; beyond the workspace the nearest
// place 5 mm inside. From a target that stands the tip goes no further than it was, nor in a stop.
// Where the straight way does not fit the joints, as near singular poses, the tip keeps its place
// and its way, and its orientation lags. `share` 0..1 slows the approach. The plan in `state`
// becomes the one from the step decided; `command` is to follow. Real-time safe, at most four
// stops.
Moved move_toward(const ArmMotion& motion, const TipSpace& space, const Pose& target, double share,
                  MotionState& state) noexcept;

// Decides one cycle of the stop plan; at rest it holds. `command` is to follow.
TipMotion brake(const ArmMotion& motion, MotionState& state) noexcept;

// Sends what was decided through the guard, which commits it, or sends what `state` becomes
// instead. Real-time safe.
Verdict command(const ArmMotion& motion, const TipMotion& decided, MotionState& state) noexcept;

// True when the arm is commanded to rest.
inline bool standing(const MotionState& state) noexcept {
  return state.joints.step.isZero(0.0) && state.joints.change.isZero(0.0);
}

// Where the commands so far bring the tip to rest [S, m]. Real-time safe.
inline Vec3 rest_place(const MotionState& state) noexcept {
  return state.stop.done() ? state.X_ST.p : state.stop.p_end;
}

}  // namespace handrail
