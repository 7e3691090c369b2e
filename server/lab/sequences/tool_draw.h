// Random orders: tools of every kind called, dropped and replaced, the clutch, the session.
#pragma once

#include "server/haptic/haptic_step.h"
#include "server/lab/sequences/draw.h"

namespace handrail {

// Chosen: what scenes call, and beyond.
inline constexpr double kFurthestAnchor = 0.050;  // from the command [m]
inline constexpr double kStiffestTool = 5000.0;   // [N/m]

// Of any kind, most of them allowed. `command`: of the tip now, frame S.
ToolCall draw_tool(Draw& draw, const Pose& command);

// Mostly of tools while something can hold them; else what leads there.
HapticOrder draw_order(Draw& draw, SessionState session, const Pose& command);

}  // namespace handrail
