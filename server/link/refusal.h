// What a slave tells a master that it does not take, because another leads.
#pragma once

#include <cstdint>
#include <string>

#include "server/base/time.h"

namespace handrail {

struct Refusal {
  std::uint64_t refused_session = 0;  // of the datagram that was refused
  bool retired = false;               // another took that session's place: it never comes back
  std::uint32_t leader_port = 0;      // UDP port of the master that leads, 1 to 65535
  Nanos led_for = 0;                  // since its session was accepted, >= 0

  friend bool operator==(const Refusal&, const Refusal&) = default;
};

// True when every field is in its range. Real-time safe.
constexpr bool sound(const Refusal& refusal) noexcept {
  return refusal.refused_session != 0 && refusal.leader_port != 0 &&
         refusal.leader_port <= UINT16_MAX && refusal.led_for >= 0;
}

// "port 47001 on this computer, for 12 s": who leads, now that `since` has passed.
inline std::string leader_text(const Refusal& refusal, Nanos since) {
  return "port " + std::to_string(refusal.leader_port) + " on this computer, for " +
         std::to_string(refusal.led_for / kSecond + since / kSecond) + " s";
}

}  // namespace handrail
