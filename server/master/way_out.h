// What a person does so that the arm moves again.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/base/joints.h"
#include "server/model/reason.h"

namespace handrail {

// What an operator has to give before the arm moves again, once its obstacle is gone.
enum class Stand : std::uint8_t {
  kLed,     // nothing: the engagement goes on, or its engage still waits
  kOff,     // an engage
  kLatched  // a reset and an engage: a side is in fault
};

// What to do about `reason` with the arm at `q`, where joint `joint` limits (-1: none or all);
// empty when nothing helps or nothing need be done.
std::string way_out_of(Reason reason, int joint, const JointVector& q, Stand stand);

enum class WayOutOrder : std::uint8_t { kTakeLease, kReset, kEngage, kClutchOff };

// Those of way_out_of() that are orders, in the order in which they are given. Empty where none
// helps: the rest is at the arm, or at the hand.
std::vector<WayOutOrder> orders_out_of(Reason reason, Stand stand);

}  // namespace handrail
