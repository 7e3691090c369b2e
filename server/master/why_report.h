// Why the robot is not where the hand is: numbers, and one line for a person.
#pragma once

#include "proto/operator.pb.h"
#include "server/master/mailboxes.h"

namespace handrail {

// Fills every field of `out` from the newest tick, at `now`.
void set_ledger(pb::Ledger* out, const HapticReport& report, const SlaveState& slave,
                const LinkSnapshot& link, Nanos now);

// What to do about `reason`; empty when nothing helps or nothing need be done.
std::string_view way_out_of(Reason reason) noexcept;

}  // namespace handrail
