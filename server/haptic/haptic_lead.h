// Who leads: the operator's orders, presence, and what the session makes of both sides.
#pragma once

#include "server/haptic/haptic_step.h"

namespace handrail {

// The hand may move the command; in hold the arm catches up when the link comes back.
inline bool may_drive(SessionState state) noexcept {
  return state == SessionState::kEngaged || state == SessionState::kHold;
}

// Carries out an order; kNone: done. `tool_distance`: as in HapticOutput [m]. Real-time safe.
Reason carry_out(const HapticSettings& settings, const HapticInput& in, const LadderStep& ladder,
                 HapticState& state, double& tool_distance) noexcept;

// Nobody there is as good as a clutch held; for long, the engagement ends. Real-time safe.
void see_presence(const HapticSettings& settings, const HapticInput& in, double dt,
                  HapticState& state) noexcept;

// One step of the session, and what it means for command and tools. Real-time safe.
void advance_session(const HapticSettings& settings, const HapticInput& in,
                     const LadderStep& ladder, double dt, HapticState& state) noexcept;

// How far an arm that stands at `X_ST` is from where the hand asks it to be by an absolute mapping.
// Real-time safe.
struct HandOff {
  double distance = 0.0;  // [m]
  double angle = 0.0;     // [rad]
};
HandOff hand_off(const HapticSettings& settings, const HapticState& state,
                 const Pose& X_ST) noexcept;

// What an engage would be refused with now; kNone: nothing. Real-time safe.
Reason obstacle_to_engaging(const HapticSettings& settings, const HapticInput& in,
                            const LadderStep& ladder, const HapticState& state) noexcept;

// The same once a reset has released what is latched on both sides. Real-time safe.
Reason obstacle_after_reset(const HapticSettings& settings, const HapticInput& in,
                            const LadderStep& ladder, const HapticState& state) noexcept;

}  // namespace handrail
