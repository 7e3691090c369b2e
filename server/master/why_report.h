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

// What an operator has to give before the arm moves again, once its obstacle is gone.
enum class Stand : std::uint8_t {
  kLed,     // nothing: the engagement goes on, or its engage still waits
  kOff,     // an engage
  kLatched  // a reset and an engage: a side is in fault
};

// What to do about `reason` with the arm at `q`, where joint `joint` limits (-1: none or all);
// empty when nothing helps or nothing need be done.
std::string way_out_of(Reason reason, int joint, const JointVector& q, Stand stand);

}  // namespace handrail
