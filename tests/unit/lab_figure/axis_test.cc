// Ranges, ticks and places on axes.
#include "server/lab/figure/axis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <set>

namespace handrail::figure {
namespace {

using testing::ElementsAre;
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::vector<std::string> labels(Scale scale, Range range, int most) {
  std::vector<std::string> out;
  for (const Tick& tick : ticks(scale, range, most)) {
    if (!tick.label.empty()) out.push_back(tick.label);
  }
  return out;
}

std::vector<double> values(Scale scale, Range range, int most) {
  std::vector<double> out;
  for (const Tick& tick : ticks(scale, range, most)) out.push_back(tick.value);
  return out;
}

TEST(LinearTicks, AreMultiplesOfOneTwoOrFive) {
  EXPECT_THAT(labels(Scale::kLinear, {0, 10}, 6), ElementsAre("0", "2", "4", "6", "8", "10"));
  EXPECT_THAT(labels(Scale::kLinear, {0, 10}, 4), ElementsAre("0", "5", "10"));
  EXPECT_THAT(labels(Scale::kLinear, {0, 10}, 11).size(), 11u);
  EXPECT_THAT(labels(Scale::kLinear, {3, 97}, 6), ElementsAre("20", "40", "60", "80"));
}

TEST(LinearTicks, AreTheExactDecimals) {
  EXPECT_THAT(values(Scale::kLinear, {0.1, 0.5}, 5), ElementsAre(0.1, 0.2, 0.3, 0.4, 0.5));
  EXPECT_THAT(labels(Scale::kLinear, {0.1, 0.5}, 5),
              ElementsAre("0.1", "0.2", "0.3", "0.4", "0.5"));
}

TEST(LinearTicks, CallZeroZero) {
  EXPECT_THAT(labels(Scale::kLinear, {-1, 1}, 5), ElementsAre("−1.0", "−0.5", "0", "0.5", "1.0"));
  EXPECT_THAT(labels(Scale::kLinear, {-0.3, 1}, 4), ElementsAre("0", "0.5", "1.0"));
  EXPECT_THAT(labels(Scale::kLinear, {-30, -10}, 3), ElementsAre("−30", "−20", "−10"));
}

TEST(LinearTicks, OfHugeAndTinyRangesArePowersOfTen) {
  EXPECT_THAT(labels(Scale::kLinear, {0, 2e8}, 5),
              ElementsAre("0", "5×10⁷", "1.0×10⁸", "1.5×10⁸", "2.0×10⁸"));
  EXPECT_THAT(labels(Scale::kLinear, {0, 4e-9}, 3), ElementsAre("0", "2×10⁻⁹", "4×10⁻⁹"));
  EXPECT_THAT(labels(Scale::kLinear, {0, 1e-250}, 2), ElementsAre("0", "10⁻²⁵⁰"));
}

TEST(LinearTicks, ANarrowRangeFarFromZeroHasLabelsThatDiffer) {
  for (const Range range : {Range{1e9, 1e9 + 1}, Range{123456.001, 123456.002}, Range{-1e-3, 2e5},
                            Range{1e6, 1e6 + 50}, Range{-1e280, 1e280}, Range{7e-280, 8e-280}}) {
    const auto found = labels(Scale::kLinear, showable(Scale::kLinear, range), 6);
    EXPECT_GE(found.size(), 2u) << range.low;
    EXPECT_LE(found.size(), 6u) << range.low;
    EXPECT_EQ(std::set<std::string>(found.begin(), found.end()).size(), found.size()) << range.low;
  }
}

TEST(LinearTicks, AreNeverMoreThanAskedForAndStayInTheRange) {
  for (int i = 1; i < 400; ++i) {
    const Range range = {-0.37 * i, 1.013 * i * i};
    for (const int most : {2, 3, 5, 8}) {
      const auto found = values(Scale::kLinear, range, most);
      EXPECT_LE(found.size(), static_cast<std::size_t>(most)) << i;
      EXPECT_GE(found.size(), 1u) << i;
      EXPECT_GE(found.front(), range.low);
      EXPECT_LE(found.back(), range.high);
    }
  }
}

TEST(LogTicks, ArePowersOfTenWithMinorOnesBetween) {
  EXPECT_THAT(labels(Scale::kLog, {1e-2, 1e2}, 5), ElementsAre("0.01", "0.1", "1", "10", "100"));
  EXPECT_EQ(values(Scale::kLog, {1e-2, 1e2}, 5).size(), 4u * 9u + 1u);
  EXPECT_THAT(labels(Scale::kLog, {1e-7, 1e-5}, 4), ElementsAre("10⁻⁷", "10⁻⁶", "10⁻⁵"));
}

TEST(LogTicks, NameTwoAndFiveWhenThereIsRoom) {
  EXPECT_THAT(labels(Scale::kLog, {1, 100}, 8),
              ElementsAre("1", "2", "5", "10", "20", "50", "100"));
  EXPECT_THAT(labels(Scale::kLog, {3, 60}, 8), ElementsAre("5", "10", "20", "50"));
}

TEST(LogTicks, NameSomeDecadesWhenThereAreTooMany) {
  EXPECT_THAT(labels(Scale::kLog, {1e-6, 1e6}, 5),
              ElementsAre("10⁻⁶", "10⁻³", "10⁰", "10³", "10⁶"));
  EXPECT_EQ(values(Scale::kLog, {1e-6, 1e6}, 5).size(), 13u) << "the others are minor";
}

TEST(LogTicks, WithinADecadeAreLinear) {
  EXPECT_THAT(labels(Scale::kLog, {6.2, 8.8}, 4), ElementsAre("7", "8"));
  for (const double v : values(Scale::kLog, {1e-12, 0.5}, 2)) EXPECT_GT(v, 0.0);
}

TEST(LogTicks, WithAPlaceForNothingHaveAZeroThereAndNoOthersBelow) {
  const std::vector<Tick> all = with_none(ticks(Scale::kLog, {0.008, 30.0}, 8), 0.01);
  ASSERT_GE(all.size(), 3u);
  EXPECT_EQ(all[0].value, 0.01);
  EXPECT_EQ(all[0].label, "0");
  EXPECT_GE(all[1].value, 0.01 * kAboveNone);
  EXPECT_EQ(all.back().value, 30.0);
}

TEST(Showable, MovesTheEndsOfASingleValueApart) {
  const Range one = showable(Scale::kLinear, {5, 5});
  EXPECT_NEAR(one.low, 4.5, 1e-12);
  EXPECT_NEAR(one.high, 5.5, 1e-12);
  const Range zero = showable(Scale::kLinear, {0, 0});
  EXPECT_EQ(zero.low, -1.0);
  EXPECT_EQ(zero.high, 1.0);
  const Range log = showable(Scale::kLog, {8, 8});
  EXPECT_EQ(log.low, 4.0);
  EXPECT_EQ(log.high, 16.0);
}

TEST(Showable, IsFiniteOrderedAndPositiveWhateverIsAsked) {
  const double odd[] = {-kInf, -1.7e308, -1, -5e-324, 0, 5e-324, 1, 1 + 1e-15, 1.7e308, kInf, kNaN};
  for (const Scale scale : {Scale::kLinear, Scale::kLog}) {
    for (const double a : odd) {
      for (const double b : odd) {
        const Range r = showable(scale, {a, b});
        EXPECT_TRUE(std::isfinite(r.low) && std::isfinite(r.high)) << a << " " << b;
        EXPECT_LT(r.low, r.high) << a << " " << b;
        EXPECT_TRUE(scale == Scale::kLinear || r.low > 0.0) << a << " " << b;
        for (const Tick& tick : ticks(scale, r, 5)) EXPECT_TRUE(std::isfinite(tick.value));
        EXPECT_LE(labels(scale, r, 5).size(), 8u) << a << " " << b;
      }
    }
  }
}

TEST(AxisMap, IsLinearInTheValueOrInItsLogarithm) {
  const AxisMap linear(Scale::kLinear, {10, 20}, 100, 300);
  EXPECT_DOUBLE_EQ(linear(10), 100);
  EXPECT_DOUBLE_EQ(linear(12.5), 150);
  EXPECT_DOUBLE_EQ(linear(25), 400);
  const AxisMap log(Scale::kLog, {1, 100}, 300, 100);
  EXPECT_DOUBLE_EQ(log(1), 300);
  EXPECT_DOUBLE_EQ(log(10), 200);
  EXPECT_DOUBLE_EQ(log(100), 100);
}

TEST(AxisMap, HasNoPlaceForWhatCannotBeShown) {
  const AxisMap linear(Scale::kLinear, {0, 1}, 0, 1), log(Scale::kLog, {1, 10}, 0, 1);
  for (const double v : {kNaN, kInf, -kInf}) EXPECT_TRUE(std::isnan(linear(v)));
  for (const double v : {kNaN, kInf, 0.0, -3.0}) EXPECT_TRUE(std::isnan(log(v)));
}

TEST(AxisMap, ClampsToItsEnds) {
  const AxisMap up(Scale::kLinear, {0, 10}, 200, 100), log(Scale::kLog, {1, 10}, 0, 50);
  EXPECT_EQ(up.clamped(kInf), 100);
  EXPECT_EQ(up.clamped(-kInf), 200);
  EXPECT_EQ(up.clamped(99), 100);
  EXPECT_EQ(up.clamped(-2), 200);
  EXPECT_DOUBLE_EQ(up.clamped(4), 160);
  EXPECT_EQ(log.clamped(0), 0);
  EXPECT_EQ(log.clamped(-1), 0);
  EXPECT_TRUE(std::isnan(up.clamped(kNaN)));
}

TEST(AxisMap, TakesTheWidestRange) {
  const AxisMap map(Scale::kLinear, showable(Scale::kLinear, {-kInf, kInf}), 0, 100);
  EXPECT_DOUBLE_EQ(map(0), 50);
}

}  // namespace
}  // namespace handrail::figure
