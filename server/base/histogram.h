// Latency histogram with fixed memory: what a loop can keep for days.
#pragma once

#include <array>
#include <cstdint>

#include "server/base/time.h"

namespace handrail {

// Counts durations in buckets of at most 6.25 % relative width (16 to an octave), from 1 ns to
// about 137 s; longer ones land in the last bucket. Adding is O(1), without allocation.
class Histogram {
 public:
  // Adds one duration; negative counts as 0. Real-time safe.
  void add(Nanos t) noexcept;
  // The smallest bucket bound that at least the share p of all samples, 0 < p <= 1, does not exceed
  // [ns]; 0 when empty.
  Nanos quantile(double p) const noexcept;
  std::uint64_t count() const noexcept { return count_; }
  // The longest sample, exactly [ns].
  Nanos max() const noexcept { return max_; }

 private:
  static constexpr int kBuckets = 16 * 34;
  std::array<std::uint32_t, kBuckets> buckets_{};
  std::uint64_t count_ = 0;
  Nanos max_ = 0;
};

}  // namespace handrail
