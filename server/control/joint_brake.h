// Braking where the straight path cannot be kept: the tip's place before its orientation.
#pragma once

#include "server/control/guard.h"
#include "server/control/tip_motion.h"

namespace handrail {

// The joint step for a cycle in which no step along the path fits the joints, as beside a singular
// pose, where keeping the orientation would spin J4 and J6. All joints slow by one share; then the
// tip is put back on the line of its last step by the joints' smallest changes, each weighed by
// what it can accelerate. The orientation may stray; the next cycles bring it back. Always within
// `box`. Real-time safe.
JointVector joint_brake(const MotionSettings& settings, const MotionState& state,
                        const StepBox& box) noexcept;

}  // namespace handrail
