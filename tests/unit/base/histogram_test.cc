#include "server/base/histogram.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace handrail {
namespace {

TEST(Histogram, IsZeroWhenEmpty) {
  const Histogram h;
  EXPECT_EQ(h.count(), 0u);
  EXPECT_EQ(h.max(), 0);
  EXPECT_EQ(h.quantile(0.5), 0);
  EXPECT_EQ(h.quantile(1.0), 0);
}

TEST(Histogram, IsExactBelowSixteenNanoseconds) {
  Histogram h;
  for (int i = 0; i < 16; ++i) h.add(i);
  for (int i = 1; i <= 16; ++i) EXPECT_EQ(h.quantile(i / 16.0), i - 1);
}

TEST(Histogram, CountsNegativeDurationsAsZero) {
  Histogram h;
  h.add(-5);
  EXPECT_EQ(h.count(), 1u);
  EXPECT_EQ(h.max(), 0);
  EXPECT_EQ(h.quantile(1.0), 0);
}

TEST(Histogram, NeverReportsMoreThanTheLongestSample) {
  Histogram h;
  h.add(1'000'003);
  EXPECT_EQ(h.max(), 1'000'003);
  EXPECT_EQ(h.quantile(0.5), 1'000'003);
  EXPECT_EQ(h.quantile(1.0), 1'000'003);
}

TEST(Histogram, BoundsEveryQuantileOfASortedReferenceWithinOneBucket) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> decades(0.0, 10.5);
    Histogram h;
    std::vector<Nanos> sorted;
    for (int i = 0; i < 20'000; ++i) {
      sorted.push_back(static_cast<Nanos>(std::pow(10.0, decades(random))));
      h.add(sorted.back());
    }
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(h.count(), sorted.size());
    EXPECT_EQ(h.max(), sorted.back());
    for (const double p : {0.0001, 0.01, 0.25, 0.5, 0.9, 0.99, 0.999, 0.9999, 1.0}) {
      const auto rank = static_cast<std::size_t>(std::ceil(p * static_cast<double>(sorted.size())));
      const Nanos exact = sorted[rank - 1];
      EXPECT_GE(h.quantile(p), exact) << "p " << p << " seed " << seed;
      EXPECT_LE(static_cast<double>(h.quantile(p)), static_cast<double>(exact) * 1.0625)
          << "p " << p << " seed " << seed;
    }
  }
}

TEST(Histogram, KeepsTheOrderOfQuantilesAcrossEveryOctave) {
  for (int bit = 0; bit < 36; ++bit) {
    Histogram h;
    const Nanos edge = Nanos{1} << bit;
    h.add(edge - 1);
    h.add(edge);
    EXPECT_EQ(h.quantile(0.5), edge - 1) << "2^" << bit;
    EXPECT_EQ(h.quantile(1.0), edge) << "2^" << bit;
  }
}

TEST(Histogram, TakesDurationsBeyondItsRange) {
  Histogram h;
  h.add(kSecond);
  h.add(1000 * kSecond);
  EXPECT_EQ(h.count(), 2u);
  EXPECT_EQ(h.max(), 1000 * kSecond);
  EXPECT_GE(h.quantile(1.0), 70 * kSecond);
}

}  // namespace
}  // namespace handrail
