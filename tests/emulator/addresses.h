// The addresses of both sides. Nothing outside the emulator's namespaces sees them.
#pragma once

#include "tests/emulator/ip_packet.h"

namespace handrail::emulator {

inline constexpr const char* kNear4 = "10.77.0.1";
inline constexpr const char* kFar4 = "10.77.0.2";
inline constexpr const char* kNear6 = "fd77::1";
inline constexpr const char* kFar6 = "fd77::2";

// What the far side sees of near: number 0 is near's own address, 10.77.0.1 and fd77::1; number n
// is 10.77.n.1 and fd77:0:0:n::1.
inline Address near_address(bool is_6, std::uint8_t number) {
  Address out;
  if (is_6) {
    out.size = 16;
    out.bytes[0] = 0xfd;
    out.bytes[1] = 0x77;
    out.bytes[7] = number;
    out.bytes[15] = 1;
  } else {
    out.bytes = {10, 77, number, 1};
  }
  return out;
}

}  // namespace handrail::emulator
