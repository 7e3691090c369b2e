// The router that near is behind: its address may change, and its ports may be translated.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <tuple>
#include <vector>

#include "server/base/random.h"
#include "server/base/time.h"
#include "tests/emulator/ip_packet.h"

namespace handrail::emulator {

struct EdgeSettings {
  bool nat = false;  // ports are translated, too, and nobody is let in whom near has not written to
  Nanos idle = 0;    // a port is given up after so long without a packet of near's; 0: never
};

// Translates packets in place and keeps their checksums as right as they were. The mapping is that
// of RFC 4787: the same for all whom near writes to; the filter is by address and port. With NAT,
// fragments do not pass, and what has no ports passes by address alone. Without, near's own address
// is seen until it roams. What is sent to an address or a port that is no longer near's is
// nobody's.
class Edge {
 public:
  explicit Edge(std::uint64_t seed) : random_(seed) {}

  EdgeSettings settings;

  // Near has another address from now on, and with NAT other ports.
  void roam() noexcept;
  // With NAT: every port changes at its next packet.
  void rebind() noexcept;

  // A packet of near's, on its way out; false: it does not pass.
  bool outward(std::span<std::uint8_t> packet, Nanos now);
  // One for near; false: it is for nobody behind this edge.
  bool inward(std::span<std::uint8_t> packet, Nanos now);

  // What the far side sees at the moment.
  Address seen_address(bool is_6) const noexcept;

 private:
  static constexpr std::size_t kMostPorts = 4096, kMostPeers = 64;
  // Whether IPv6, protocol, port.
  using Key = std::tuple<bool, std::uint8_t, std::uint16_t>;
  struct Mapping {
    std::uint16_t outer = 0;
    Nanos used = 0;
    std::vector<Endpoint> peers;  // whom near has written to, the newest last
  };

  bool alive(const Mapping& mapping, Nanos now) const noexcept;
  // nullptr: all are in use.
  Mapping* mapping_of(const Key& inner, Nanos now);
  void forget(std::map<Key, Mapping>::iterator at);

  Random random_;
  std::uint8_t moved_ = 0;  // how often
  std::map<Key, Mapping> mappings_;
  std::map<Key, Key> inner_of_;  // by the port that is seen
};

}  // namespace handrail::emulator
