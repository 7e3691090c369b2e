#include "server/base/histogram.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace handrail {
namespace {

// Values below 16 have a bucket each; above, the top four bits after the leading one choose
// among 16.
int bucket_of(std::uint64_t v) {
  if (v < 16) return static_cast<int>(v);
  const int octave = static_cast<int>(std::bit_width(v)) - 5;
  return 16 * (octave + 1) + static_cast<int>((v >> octave) & 15);
}

Nanos upper_bound_of(int bucket) {
  if (bucket < 16) return bucket;
  const int octave = bucket / 16 - 1;
  return ((Nanos{16} + bucket % 16 + 1) << octave) - 1;
}

}  // namespace

void Histogram::add(Nanos t) noexcept {
  t = std::max<Nanos>(t, 0);
  ++buckets_[static_cast<std::size_t>(
      std::min(bucket_of(static_cast<std::uint64_t>(t)), kBuckets - 1))];
  ++count_;
  max_ = std::max(max_, t);
}

Nanos Histogram::quantile(double p) const noexcept {
  if (count_ == 0) return 0;
  const auto wanted =
      static_cast<std::uint64_t>(std::ceil(std::clamp(p, 0.0, 1.0) * static_cast<double>(count_)));
  std::uint64_t seen = 0;
  for (int i = 0; i < kBuckets; ++i) {
    seen += buckets_[static_cast<std::size_t>(i)];
    if (seen >= std::max<std::uint64_t>(wanted, 1)) return std::min(upper_bound_of(i), max_);
  }
  return max_;
}

}  // namespace handrail
