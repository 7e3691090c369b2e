// Both sides of an emulated network in virtual time, for its tests.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "tests/emulator/network.h"
#include "tests/unit/emulator/packet_samples.h"

namespace handrail::emulator {

struct Got {
  Arrived arrived;
  std::uint32_t written = 0;  // the number in its payload
  Bytes packet;
};

// Near sends to far every millisecond, and far to where it heard from last.
class Bench {
 public:
  explicit Bench(std::uint64_t seed, const NetworkPlan& plan = {}) : network(seed) {
    network.begin(plan, 0);
  }

  void take(Nanos until) {
    Bytes out(kLongestPacket);
    while (const auto arrived = network.take(until, out)) {
      const Bytes packet(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(arrived->size));
      (arrived->at == Side::kFar ? far : near).push_back({*arrived, number_of(packet), packet});
      const auto layout = layout_of(packet);
      if (arrived->at == Side::kFar && layout) heard_ = source_of(packet, *layout);
    }
  }
  void exchange(std::uint32_t count, bool is_6 = false) {
    if (heard_.port == 0) heard_ = near_end(is_6);
    for (std::uint32_t i = 0; i < count; ++i) {
      const Nanos now = sent_++ * kMillisecond;
      take(now);
      network.send(Side::kNear, numbered(i, near_end(is_6), far_end(is_6)), now);
      network.send(Side::kFar, numbered(i, far_end(is_6), heard_), now);
    }
  }
  void finish() { take(kForever - 1); }

  Network network;
  std::vector<Got> far, near;  // what arrived there

 private:
  Nanos sent_ = 0;
  Endpoint heard_;
};

inline void expect_accounted(const Counts& counts) {
  EXPECT_EQ(counts.sent + counts.duplicated + counts.replayed + counts.injected,
            counts.lost + counts.dark + counts.overflow + counts.nobodys + counts.delivered);
}

}  // namespace handrail::emulator
