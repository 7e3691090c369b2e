// The last function before the actuator: small, pure, without I/O.
//
// It passes a command or brakes; it never steers. Whatever it answers leaves
// every joint able to stop within its range, speed, acceleration and jerk by
// the stop law of jerk_law.h, and the stop law keeps what it starts with; so no
// sequence of commands can break a limit.
#pragma once

#include <array>
#include <cstdint>

#include "server/base/joints.h"
#include "server/kinematics/rv2a.h"
#include "server/model/reason.h"
#include "server/motion/jerk_law.h"

namespace handrail {

// Where the commanded tip may be, frame S [m].
struct Workspace {
  Vec3 low = Vec3(-2.0, -2.0, -2.0);
  Vec3 high = Vec3(2.0, 2.0, 2.0);
};

// What all joints may do in a cycle, in units of it.
struct JointBounds {
  JointVector speed, acceleration, jerk;
  JointVector per_jerk;
  JointVector plain_lower, plain_upper;  // so far inside the range that any stop ends there [rad]

  // Whether each joint plainly keeps within speed, acceleration and jerk by this step, and can
  // still come to rest within them and its range: sufficient, and cheap. All finite. `last_change`:
  // of the step before. Real-time safe.
  bool plainly_hold(const JointVector& wanted, const JointVector& step, const JointVector& change,
                    const JointVector& last_change) const noexcept {
    const JointVector a = change.cwiseAbs();
    const JointVector fast = step.cwiseAbs() + 0.5 * a.cwiseProduct(a).cwiseProduct(per_jerk);
    const JointVector room = (acceleration - a)
                                 .cwiseMin(jerk - (change - last_change).cwiseAbs())
                                 .cwiseMin(speed - fast)
                                 .cwiseMin(plain_upper - wanted)
                                 .cwiseMin(wanted - plain_lower);
    return room.minCoeff() >= 0.0;
  }
};

// The joints' limits in units of the cycle, with what the checks need worked out once.
struct GuardLimits : JointBounds {
  // `dt` > 0 [s]. Every limit positive.
  GuardLimits(const JointLimits& joints, const ArmGeometry& arm, const Workspace& workspace,
              double dt) noexcept;

  std::array<AxisLimits, kJoints> axis;
  JointVector half_per_acceleration;
  JointVector stop_time;     // of a stop, beyond speed / 2 acceleration [cycles]
  JointVector lower, upper;  // [rad]
  JointVector plenty;        // more room to a range's end than any stop takes [rad]
  JointVector lever;         // the tip moves at most this far with one radian of the joint [m]
  double furthest = 0.0;     // more than the tip goes in any stop [m]
  ArmGeometry arm;
  Workspace workspace;
};

// The last three commands: `q` [rad], its step and the step's change [rad].
// Commanded, never measured.
struct GuardState {
  JointVector q = JointVector::Zero();
  JointVector step = JointVector::Zero();
  JointVector change = JointVector::Zero();
  double clearance = 0.0;  // the tip is at least this far inside the workspace;
                           // 0: not known [m]
};

struct Verdict {
  Reason reason = Reason::kNone;  // kNone: passes
  std::int8_t joint = -1;         // 0..5, the joint to blame; -1: the tip, or all
};

// What guard() would say of `wanted`. Checks finite, workspace, joint range,
// speed, acceleration, jerk. A state out of its limits may come back. Real-time
// safe.
Verdict guard_allows(const GuardLimits& limits, const GuardState& state,
                     const JointVector& wanted) noexcept;

// The same of a command that the joints' bounds plainly hold: the workspace alone is asked for.
Verdict guard_allows_tip(const GuardLimits& limits, const GuardState& state,
                         const JointVector& wanted, const JointVector& step,
                         const JointVector& change) noexcept;

// Lets `wanted` pass bit for bit if it is allowed; else every joint takes one
// cycle of its stop law. state.q is what to send. For every input it is within
// every limit if `state` was. Real-time safe.
Verdict guard(const GuardLimits& limits, GuardState& state, const JointVector& wanted) noexcept;

// One cycle of every joint's stop law. Real-time safe.
void guard_brake(const GuardLimits& limits, GuardState& state) noexcept;

}  // namespace handrail
