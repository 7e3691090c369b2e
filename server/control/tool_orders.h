// What calling and dropping tools does to the guide and to the hand's place.
#pragma once

#include "server/control/haptic_step.h"

namespace handrail {

// Calls a tool while engaged or clutched; `distance`: of a position tool from the command [m]. A
// call with `approach` latches the hand where the tool will be reached: as after a clutch, nothing
// pulls it there. It wants a hand that drives. Real-time safe.
Reason call_tool(const HapticSettings& settings, const ToolCall& call, HapticState& s,
                 double& distance) noexcept;

// Drops the tools named; kNoSuchTool when none of them was there. An approach ends where the
// command has come to, and the hand is latched there. Real-time safe.
Reason drop_tools(const HapticSettings& settings, bool position, bool orientation,
                  HapticState& s) noexcept;

}  // namespace handrail
