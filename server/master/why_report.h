// Why the robot is not where the hand is: numbers, and one line for a person.
#pragma once

#include "proto/operator.pb.h"
#include "server/master/mailboxes.h"

namespace handrail {

// What the slave said is of the present: anything older and its link is lost.
inline constexpr Nanos kHeardLately = 200 * kMillisecond;

// Fills every field of `out` from the newest tick, at `now`.
void set_ledger(pb::Ledger* out, const HapticReport& report, const SlaveState& slave,
                const LinkSnapshot& link, Nanos now);

}  // namespace handrail
