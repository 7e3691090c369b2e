// What calling and dropping tools does to the guide and to the hand's place.
#pragma once

#include "server/haptic/haptic_step.h"

namespace handrail {

// Calls a tool while engaged or clutched. `p_ST`: the tip [S, m]; `distance`: of a position tool,
// as in Guide::call [m]. A call with `approach` latches the hand where the tool will be
// reached: as after a clutch, nothing pulls it there. It wants a hand that drives. A hand further
// off than the reach of tools is latched where the command is. A call with a reference latches how
// the hand is turned; with the clutch held the arm turns once the hand drives. Real-time safe.
Reason call_tool(const HapticSettings& settings, const ToolCall& call, const Vec3& p_ST,
                 HapticState& s, double& distance) noexcept;

// Drops the tools named; kNoSuchTool when none of them was there. Where an approach or a
// way to a reference ends, or where the hand is further off than the reach of tools, it is latched
// where the command is: the arm does not go on by itself. Real-time safe.
Reason drop_tools(const HapticSettings& settings, bool position, bool orientation,
                  HapticState& s) noexcept;

}  // namespace handrail
