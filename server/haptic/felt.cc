#include "server/haptic/felt.h"

#include <algorithm>
#include <cmath>

#include "server/haptic/haptic_lead.h"

namespace handrail {
namespace {

Felt felt_of(Cue cue) noexcept {
  switch (cue) {
    case Cue::kHold: return Felt::kHold;
    case Cue::kLost: return Felt::kLost;
    case Cue::kLimit: return Felt::kLimit;
    case Cue::kSingularity: return Felt::kSingularity;
    case Cue::kNone: break;
  }
  return Felt::kNothing;
}

}  // namespace

HapticCue felt_after(const HapticInput& in, const HapticState& state) noexcept {
  if (!in.hand.valid) return {};
  const CuePlayer& cue = state.force.cue;
  if (cue.plays() != Cue::kNone) return {felt_of(cue.plays()), cue.trembles() ? 1.0 : 0.0};
  const bool fresh = in.slave_known && in.slave_age < kFeltContactStands;
  if (!may_drive(state.lead.session) || !fresh || !in.slave.has_wrench) return {};
  const double force = in.slave.f_E_S.force.norm();
  if (!std::isfinite(force) || force <= kLeastFeltContact) return {};
  return {Felt::kContact,
          std::min(1.0, (force - kLeastFeltContact) / (kMostFeltContact - kLeastFeltContact))};
}

}  // namespace handrail
