// What the hand is to feel beside force, as devices that make none can show it.
#pragma once

#include "server/haptic/haptic_step.h"
#include "server/model/haptic_cue.h"

namespace handrail {

// Contact is felt from the first to the second, in proportion. Ours: below the first lies the noise
// of sensors and payload, at the second the bumper yields.
inline constexpr double kLeastFeltContact = 2.0;  // [N]
inline constexpr double kMostFeltContact = 10.0;  // [N]
// A contact that is older says nothing of now.
inline constexpr Nanos kFeltContactStands = 100 * kMillisecond;

// After a step with `in` that led to `state`: the cue that plays, else the contact of an arm that
// is led. Nothing of a hand that the device does not tell of. Pure.
HapticCue felt_after(const HapticInput& in, const HapticState& state) noexcept;

}  // namespace handrail
