#include "server/base/random.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>

namespace handrail {
namespace {

// First outputs of splitmix64 from 0 are published (e220a8397b1dcdaf ...); with them as state,
// xoshiro256++ starts as computed here in words.
TEST(Random, StartsFromThePublishedStateFilling) {
  const std::uint64_t s0 = 0xe220a8397b1dcdafULL;
  const std::uint64_t s3 = 0xf88bb8a8724c81ecULL;
  Random random(0);
  EXPECT_EQ(random.bits(), std::rotl(s0 + s3, 23) + s0);
}

TEST(Random, SameSeedSameNumbers) {
  Random first(7);
  Random again(7);
  Random other(8);
  int equal = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::uint64_t bits = first.bits();
    EXPECT_EQ(bits, again.bits());
    equal += bits == other.bits() ? 1 : 0;
  }
  EXPECT_EQ(equal, 0);
}

TEST(Random, UniformFillsTheUnitIntervalEvenly) {
  Random random(1);
  std::array<int, 10> counts{};
  for (int i = 0; i < 100'000; ++i) {
    const double u = random.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    ++counts[static_cast<std::size_t>(u * 10.0)];
  }
  for (const int count : counts) EXPECT_NEAR(count, 10'000, 500);
}

TEST(Random, NormalHasTheMomentsOfTheNormalDistribution) {
  Random random(1);
  constexpr int kDraws = 200'000;
  std::array<double, 5> moment{};
  double neighbours = 0.0;
  double previous = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = random.normal();
    ASSERT_TRUE(std::isfinite(x));
    for (std::size_t k = 1; k < moment.size(); ++k) moment[k] += std::pow(x, k) / kDraws;
    neighbours += x * previous / kDraws;
    previous = x;
  }
  // Five standard deviations of each estimate.
  EXPECT_NEAR(moment[1], 0.0, 0.0112);
  EXPECT_NEAR(moment[2], 1.0, 0.0159);
  EXPECT_NEAR(moment[3], 0.0, 0.0434);
  EXPECT_NEAR(moment[4], 3.0, 0.11);
  EXPECT_NEAR(neighbours, 0.0, 0.0112);
}

}  // namespace
}  // namespace handrail
