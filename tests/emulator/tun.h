// The wire's end within a network namespace: a TUN device, its addresses and routes.
#pragma once

#include "server/base/status.h"
#include "tests/emulator/network.h"

namespace handrail::emulator {

inline constexpr const char* kTunName = "hr0";

// Loopback and the device of the calling process' network namespace, both up; everything that is
// not its own goes to the device. `mtu`: 1280 to kLongestPacket [bytes]. The device's descriptor,
// which does not block; the error says what the machine refuses. Without IPv6 in the kernel the
// side has IPv4 alone.
Result<int> open_wire(Side side, int mtu);

}  // namespace handrail::emulator
