// What the emulator's taps say of the link: what was sent, and what of it arrived when.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "server/base/status.h"
#include "server/base/time.h"
#include "server/lab/network/link_way.h"

namespace handrail::faults {

// A state of the master's that was newer than all that had arrived at the slave before.
struct FreshState {
  Nanos sent = 0, at = 0;    // when the master sent it, and when it arrived
  std::uint64_t number = 0;  // among all that near sent
};

struct WireTruth {
  std::vector<FreshState> to_slave;  // by arrival
  std::vector<Nanos> to_master;      // when something newer of the slave's arrived
  // Datagrams delivered to the slave's port, by Origin; the genuine ones without those overtaken.
  std::array<std::uint64_t, 5> at_slave{};
  std::uint64_t overtaken = 0;
  std::uint64_t longest = 0;  // UDP payload of either side [bytes]

  std::uint64_t delivered(Origin origin) const {
    return at_slave[static_cast<std::size_t>(origin)];
  }
};

inline constexpr std::uint16_t kLinkPort = 47002;  // of slaves, when their configuration says none
inline constexpr std::uint8_t kApplicationData = 23;  // the type of a record of DTLS
inline constexpr std::size_t kUdpHeader = 8;          // [bytes]
inline constexpr int kTapBytes = 64;  // of each packet: IP, UDP and a record's header

// Reads near.pcap and far.pcap of `folder`. Only what carries a state counts as one: application
// data of DTLS over IPv4.
Result<WireTruth> read_truth(const std::string& folder);

}  // namespace handrail::faults
