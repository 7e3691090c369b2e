// What the rig knows of the network: who sent a packet, and a switch that loses some.
#pragma once

#include <cstdint>

#include "server/base/random.h"

namespace handrail {

// Who sent a datagram, as the transport names it (such as address and port in one number).
using PeerId = std::uint64_t;

// Every packet is lost with the same probability, independently, from a seed. Real-time safe.
class LossySwitch {
 public:
  // `share` of packets lost, 0 to 1.
  LossySwitch(std::uint64_t seed, double share) noexcept : random_(seed), share_(share) {}

  bool passes() noexcept {
    if (share_ <= 0.0 || random_.uniform() >= share_) return true;
    ++dropped_;
    return false;
  }
  std::uint64_t dropped() const noexcept { return dropped_; }

 private:
  Random random_;
  double share_;
  std::uint64_t dropped_ = 0;
};

}  // namespace handrail
