// Whether somebody is there: the dead-man's switch.
#pragma once

#include <cstdint>

#include "server/base/time.h"

namespace handrail {

// What proves it. Without presence the arm holds as if clutched.
enum class Presence : std::uint8_t {
  kNone,    // nothing needed
  kButton,  // the device's third button, while held
  kHold     // a running `handrail engage --hold`
};

// A running `engage --hold` says so at least this often.
inline constexpr Nanos kHoldPatience = 200 * kMillisecond;

}  // namespace handrail
