// A step where the straight one does not fit the joints: beside a singular pose, round the base
// axis, where a joint's range bends the way.
#pragma once

#include "server/motion/stop_plan.h"

namespace handrail {

// The step in which every joint goes toward where it is `there`, all to arrive together, as near as
// may be so that the tip moves to `p` and stays on `space`. So near a singular pose the tip keeps
// its place and its way, and the orientation lags and comes back by the joints' own way. `speed`
// 0..1: of the joints'. False when there is no such step. Real-time safe, at most 28 solutions of
// six equations.
bool slide(const PlanLimits& limits, const TipSpace& space, const TipMotion& from,
           const JointVector& there, const Vec3& p, double speed, JointVector& q) noexcept;

// The same without regard to the tip. Real-time safe.
JointVector own_way(const PlanLimits& limits, const GuardState& joints, const JointVector& there,
                    double speed) noexcept;

// About how many cycles that way takes.
double own_cycles(const PlanLimits& limits, const JointVector& q,
                  const JointVector& there) noexcept;

// How much further from p the joints' own way from q takes the tip than it is at q [m].
double detour(const ArmGeometry& arm, const JointVector& q, const JointVector& there,
              const Vec3& p) noexcept;

}  // namespace handrail
