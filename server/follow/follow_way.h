// The way of a command to the arm: tool, contact, reach and limits, each a stage that says where it
// puts the tip and why.
#pragma once

#include "server/follow/follow_step.h"

namespace handrail {

inline bool valid_command(const MasterState& master) noexcept {
  return master.has_command && is_place(master.X_SU);
}

// What a cycle decided, and what intervened.
struct Led {
  TipMotion next;
  Reason why = Reason::kNone;
};

// Decides one cycle toward the master's newest command; brakes where that is not to be followed.
// `ledger` gets what each stage did. Real-time safe.
Led lead(const FollowSettings& settings, const FollowInput& in, FollowState& state,
         FollowLedger& ledger) noexcept;

}  // namespace handrail
