// Moving the tip toward a target pose within the arm's limits, along the path.
#pragma once

#include "server/base/joints.h"
#include "server/base/reason.h"
#include "server/base/spatial.h"
#include "server/kinematics/rv2a.h"

namespace handrail {

struct MotionSettings {
  ArmGeometry arm;
  JointLimits limits;
  double tip_speed = 1.0;  // [m/s]
  double dt = 0.0071;      // controller cycle [s]
};

// Where the commands stand. Everything is commanded, nothing measured.
struct MotionState {
  JointVector q = JointVector::Zero();     // last joint command [rad]
  JointVector step = JointVector::Zero();  // last joint step [rad]
  Pose X_ST;                               // tip at q
  Twist tip_step;                          // last tip step, frame S [m], [rad]
};

// Stands still at `q`.
MotionState standing_at(const ArmGeometry& arm, const JointVector& q) noexcept;

// One cycle toward `target`: the tip moves along the straight line and the shortest turn to it, as
// far as joint range, speed and acceleration allow, and slow enough to stop on the target. A limit
// shortens the step in Cartesian space, all six axes together, and a change of direction is a blend
// of the last step and the wanted one; so a tip on a line, plane or point stays on it. `share` 0..1
// slows the approach. Returns what limited the step, kNone if nothing did. Real-time safe, at most
// ten inverse kinematics.
Reason move_toward(const MotionSettings& settings, const Pose& target, double share,
                   MotionState& state) noexcept;

// One cycle of stopping on the path, as fast as the slowest-stopping joint allows.
void brake(const MotionSettings& settings, MotionState& state) noexcept;

// True when the last step was none.
inline bool standing(const MotionState& state) noexcept { return state.step.isZero(0.0); }

}  // namespace handrail
