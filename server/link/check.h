// What a state must satisfy to cross the link. One validator for both directions, so that nothing
// is sent that the other side would refuse.
#pragma once

#include "server/link/reject.h"
#include "server/model/link_state.h"

namespace handrail {

// Tolerance of unit vectors and quaternions, on the squared length.
inline constexpr double kUnitTolerance = 1e-6;

// kNone when the state is sound: enums in range, all numbers finite, unit quaternions, positions
// within kFarthest (spatial.h), tools that agree with their kind (tool.h: fields a kind does not
// use are at their defaults), a surface within its limits (surface.h), a scene name of letters,
// digits, - and _ that is zero-padded. Real-time safe.
Reject check(const MasterState& state) noexcept;
Reject check(const SlaveState& state) noexcept;

// One tool in its slot, as above: kTool, kNotFinite, kRange or kRotation name what is wrong.
Reject check_position_tool(const ToolDefinition& tool) noexcept;
Reject check_orientation_tool(const ToolDefinition& tool) noexcept;

}  // namespace handrail
