// Datagrams of somebody who has no key but sees the wire, as taps that the emulator replays.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/base/random.h"
#include "server/base/status.h"
#include "tests/emulator/ip_packet.h"

namespace handrail::faults {

using Bytes = std::vector<std::uint8_t>;

// What the taps of a running bed show of the newest session, to who reads along.
struct SeenSession {
  emulator::Endpoint master, slave;  // as far sees them
  std::uint64_t record = 0;          // epoch and sequence of the master's newest record
  Bytes hello;                       // a ClientHello that carried a cookie
  Bytes first_hello;                 // one without
};

// Of the tap far.pcap, whole packets, of the slave's side. The error says what is not in it.
Result<SeenSession> see_session(const std::string& path);

// A record of DTLS 1.2 around `body`.
Bytes record_of(std::uint8_t type, std::uint64_t epoch_and_sequence, const Bytes& body);
Bytes random_bytes(Random& random, std::size_t size);

// A tap whose packets `count` calls of `next` give.
Status write_packets(const std::string& path, int count, Bytes (*next)(void*, int), void* of);
template <typename Next>
Status write_packets(const std::string& path, int count, Next next) {
  return write_packets(
      path, count, [](void* of, int i) { return (*static_cast<Next*>(of))(i); }, &next);
}

}  // namespace handrail::faults
