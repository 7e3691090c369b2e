#include "tests/storm/slope.h"

#include <gtest/gtest.h>

#include "server/base/random.h"

namespace handrail::storm {
namespace {

struct Samples {
  std::vector<double> times, values;
};

// `rate` a second, uniform noise of `noise` to both sides.
Samples line(double rate, double noise, int count, std::uint64_t seed) {
  Random random(seed);
  Samples out;
  for (int i = 0; i < count; ++i) {
    out.times.push_back(i);
    out.values.push_back(20.0 + rate * i + noise * (2.0 * random.uniform() - 1.0));
  }
  return out;
}

TEST(RobustSlope, OfAStraightLineIsItsOwn) {
  for (const int count : {3, 100, 1440}) {
    const Samples s = line(0.25, 0.0, count, 1);
    const Slope slope = robust_slope(s.times, s.values);
    EXPECT_NEAR(slope.value, 0.25, 1e-9) << count;
    EXPECT_NEAR(slope.low, 0.25, 1e-9) << count;
    EXPECT_NEAR(slope.high, 0.25, 1e-9) << count;
  }
}

TEST(RobustSlope, ItsIntervalHoldsTheTruthNineteenTimesInTwenty) {
  int held = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    const Samples s = line(0.01, 1.0, 60, seed);
    const Slope slope = robust_slope(s.times, s.values);
    held += slope.low <= 0.01 && 0.01 <= slope.high;
  }
  EXPECT_GE(held, 365);
  EXPECT_LE(held, 394);
}

TEST(RobustSlope, AFifthOfWildSamplesDoesNotMatter) {
  Samples s = line(0.01, 0.1, 600, 3);
  for (std::size_t i = 0; i < s.values.size(); i += 5) s.values[i] = 1000.0;
  EXPECT_NEAR(robust_slope(s.times, s.values).value, 0.01, 0.003);
}

TEST(RobustSlope, SeesASlowLeakBesideASteadyOne) {
  EXPECT_GT(
      robust_slope(line(1.0 / 3600, 0.01, 540, 4).times, line(1.0 / 3600, 0.01, 540, 4).values).low,
      0.5 / 3600);
  const Samples steady = line(0.0, 0.0, 540, 5);
  EXPECT_EQ(robust_slope(steady.times, steady.values).value, 0.0);
}

TEST(RobustSlope, OfTooFewThereIsNone) {
  EXPECT_EQ(robust_slope({}, {}).value, 0.0);
  EXPECT_EQ(robust_slope({0.0, 1.0}, {0.0, 1.0}).value, 0.0);
}

}  // namespace
}  // namespace handrail::storm
