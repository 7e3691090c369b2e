// The last function before the actuator: small, pure, without I/O.
#pragma once

#include "server/base/joints.h"
#include "server/base/reason.h"

namespace handrail {

// Longest step with `room` left ahead from which the steps that follow, each shorter by `a` > 0,
// still end within the room. Steps y, y - a, y - 2a, ... sum to at most (y + a/2)^2 / (2a). Any
// unit, as long as both have it. Real-time safe.
double longest_stoppable(double room, double a) noexcept;

// What one cycle's joint step may be, given where the last command stands and how fast it moves.
struct StepBox {
  JointVector low;    // <= high [rad]
  JointVector high;   // [rad]
  JointVector brake;  // the step that slows every joint as fast as allowed; always within the box

  bool contains(const JointVector& step) const noexcept {
    // Negated so that a NaN is outside.
    return !((step - low).minCoeff() < -kTolerance) && !((high - step).minCoeff() < -kTolerance) &&
           step.allFinite();
  }
  // Largest s in 0..1 for which from + s (to - from) stays in the box, `from` being in it.
  double largest_share(const JointVector& from, const JointVector& to) const noexcept;

  static constexpr double kTolerance = 1e-12;  // [rad]
};

// The box of steps from `q` after a step `last`, both commanded, never measured (limiting against
// the measured position halves the speed). `margin` in (0, 1] takes that share of speed and
// acceleration. Each joint can still stop before the end of its range with the share `reserve` of
// its acceleration. dt > 0 [s]. Real-time safe.
StepBox step_box(const JointLimits& limits, const JointVector& q, const JointVector& last,
                 double dt, double margin, double reserve) noexcept;

struct Guarded {
  JointVector q;                  // safe to send
  Reason reason = Reason::kNone;  // kGuard when it is not what was asked
};

// Lets `q_wanted` pass if the step to it is in the box; else takes the furthest safe step toward
// it, or brakes when it is not finite. For every input the result is finite, within speed and
// acceleration of `q` and `last`, and never closer to a range end than the joint can stop, if the
// same held for `q` and `last`. Real-time safe.
Guarded guard(const JointLimits& limits, const JointVector& q, const JointVector& last,
              const JointVector& q_wanted, double dt) noexcept;

}  // namespace handrail
