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
// Absent for longer ends the engagement [s].
inline constexpr double kAbsence = 2.0;

// `button`: held now; `hold_heard`: since the running command was last heard [ns]. Real-time safe.
constexpr bool present(Presence wanted, bool button, Nanos hold_heard) noexcept {
  switch (wanted) {
    case Presence::kNone: return true;
    case Presence::kButton: return button;
    case Presence::kHold: return hold_heard <= kHoldPatience;
  }
  return false;
}

}  // namespace handrail
