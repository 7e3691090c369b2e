// What a network does to its datagrams, as settings.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "server/base/time.h"

namespace handrail {

// What one way does to its datagrams. Shares are 0 to 1. Burst loss is Gilbert and Elliott's: per
// datagram the way turns bad with `burst_enter` and good with `burst_leave`; a bad one loses all.
struct LinkFaults {
  Nanos delay = 0;
  Nanos jitter = 0;  // delay is uniform within +-jitter, never below 0
  double loss = 0.0;
  double burst_enter = 0.0;
  double burst_leave = 1.0;
  double duplicate = 0.0;  // comes once more, after a delay of its own
  double reorder = 0.0;    // may overtake and be overtaken, `reorder_by` later; the rest keep order
  Nanos reorder_by = 0;
  double replay = 0.0;             // earlier datagrams sent again for each new one; may exceed 1
  double corrupt = 0.0;            // with 1 to `corrupt_bits` bits flipped
  std::uint64_t corrupt_bits = 8;  // at least 1
  // Damaged copies that come beside each one; may exceed 1.
  double corrupt_copies = 0.0;
  std::int64_t rate_bps = 0;  // 0: without limit
  Nanos queue = kSecond;      // what waits longer for the rate is dropped
};

// A network that has a name: both ways do the same.
struct KnownNetwork {
  std::string_view name;
  std::string_view what;  // for people
  LinkFaults way;
};

// The first does nothing. Not real-time safe at its first call.
std::span<const KnownNetwork> known_networks();
// nullptr: there is none of that name.
const KnownNetwork* find_network(std::string_view name);

}  // namespace handrail
