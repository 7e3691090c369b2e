// Statistics of simulated people against answers worked out by hand.
#include "server/lab/study/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace handrail {
namespace {

constexpr double kFailed = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// People of one trial each.
ByPerson people_of(const std::vector<double>& values) {
  ByPerson out;
  for (const double v : values) out.push_back({v});
  return out;
}

TEST(Quantile, InterpolatesBetweenRanks) {
  const std::vector<double> values = {7, 1, 4, 2};  // ranks 0 to 3 are 1, 2, 4, 7
  EXPECT_DOUBLE_EQ(quantile(values, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(quantile(values, 0.25), 1.75);  // rank 0.75
  EXPECT_DOUBLE_EQ(quantile(values, 0.5), 3.0);    // rank 1.5
  EXPECT_DOUBLE_EQ(quantile(values, 0.75), 4.75);  // rank 2.25
  EXPECT_DOUBLE_EQ(quantile(values, 0.9), 6.1);    // rank 2.7
  EXPECT_DOUBLE_EQ(quantile(values, 1.0), 7.0);
}

TEST(Quantile, KeepsQWithinZeroAndOne) {
  EXPECT_EQ(quantile({3, 1, 2}, -0.5), 1.0);
  EXPECT_EQ(quantile({3, 1, 2}, 1.5), 3.0);
}

TEST(Quantile, OfOneValueIsThatValue) {
  for (const double q : {0.0, 0.3, 1.0}) EXPECT_EQ(quantile({5.5}, q), 5.5);
}

TEST(Quantile, IsInfiniteAsSoonAsAFailureHasAShare) {
  const std::vector<double> values = {1, 2, 3, kFailed, kFailed};
  EXPECT_EQ(quantile(values, 0.5), 3.0) << "the middle rank finished";
  EXPECT_EQ(quantile(values, 0.51), kFailed);
  EXPECT_EQ(quantile(values, 0.9), kFailed) << "between two failures";
  EXPECT_EQ(median({1, 2, kFailed, kFailed}), kFailed) << "half the trials failed";
  EXPECT_EQ(median({1, 2, kFailed}), 2.0);
}

TEST(Summary, OfFiniteValues) {
  const Summary s = summarise({9, 1, 3, 5, 7});
  EXPECT_EQ(s.min, 1.0);
  EXPECT_EQ(s.q1, 3.0);
  EXPECT_EQ(s.median, 5.0);
  EXPECT_EQ(s.q3, 7.0);
  EXPECT_EQ(s.max, 9.0);
  EXPECT_EQ(s.mean, 5.0);
  EXPECT_EQ(s.count, 5u);
  EXPECT_EQ(s.failures, 0u);
}

TEST(Summary, RanksFailuresLastAndLeavesThemOutOfTheMean) {
  const Summary s = summarise({kFailed, 4, 2, 6});
  EXPECT_EQ(s.min, 2.0);
  EXPECT_DOUBLE_EQ(s.q1, 3.5);      // rank 0.75
  EXPECT_DOUBLE_EQ(s.median, 5.0);  // rank 1.5
  EXPECT_EQ(s.q3, kFailed);         // rank 2.25
  EXPECT_EQ(s.max, 6.0);
  EXPECT_EQ(s.mean, 4.0);
  EXPECT_EQ(s.count, 4u);
  EXPECT_EQ(s.failures, 1u);
}

TEST(Summary, CountsWhatIsNotANumberAsFailed) {
  for (const double broken : {kNaN, -kFailed}) {
    const Summary s = summarise({broken, 1, 3});
    EXPECT_EQ(s.failures, 1u);
    EXPECT_EQ(s.min, 1.0);
    EXPECT_EQ(s.median, 3.0);
    EXPECT_EQ(s.mean, 2.0);
  }
}

TEST(Summary, OfFailuresOnlyHasQuantilesButNoMean) {
  const Summary s = summarise({kFailed, kFailed});
  EXPECT_EQ(s.median, kFailed);
  EXPECT_EQ(s.failures, 2u);
  for (const double v : {s.min, s.max, s.mean}) EXPECT_TRUE(std::isnan(v));
}

TEST(Summary, OfNothingIsNaN) {
  const Summary s = summarise({});
  EXPECT_EQ(s.count, 0u);
  for (const double v : {s.min, s.q1, s.median, s.q3, s.max, s.mean}) EXPECT_TRUE(std::isnan(v));
}

TEST(Bootstrap, OfTwoPeopleSpansBoth) {
  // A quarter of the resamples are all of one person, a quarter all of the other.
  Random random(1);
  const Interval i = bootstrap_median({{2, 2, 2}, {8, 8, 8}}, random);
  EXPECT_EQ(i.low, 2.0);
  EXPECT_EQ(i.high, 8.0);
}

TEST(Bootstrap, OfOnePersonIsAPoint) {
  Random random(1);
  const Interval i = bootstrap_median({{1, 5, 9}}, random);
  EXPECT_EQ(i.low, 5.0);
  EXPECT_EQ(i.high, 5.0);
}

TEST(Bootstrap, MoreTrialsOfTheSamePeopleAddNoCertainty) {
  const std::vector<double> values = {3, 9, 4, 7, 1, 8, 2};
  ByPerson once = people_of(values), often;
  for (const double v : values) often.push_back(std::vector<double>(50, v));
  Random a(5), b(5);
  const Interval i = bootstrap_median(once, a), j = bootstrap_median(often, b);
  EXPECT_EQ(i.low, j.low);
  EXPECT_EQ(i.high, j.high);
  EXPECT_LT(i.low, 4.0);
  EXPECT_GT(i.high, 4.0);
}

TEST(Bootstrap, HoldsTheTrueMedianAboutAsOftenAsItSays) {
  // People differ by a normal of 1, their trials by one of 0.5; the median of all is 10.
  Random random(42);
  int held = 0;
  constexpr int kStudies = 400;
  double width = 0.0;
  for (int study = 0; study < kStudies; ++study) {
    ByPerson people(25);
    for (auto& person : people) {
      const double own = 10.0 + random.normal();
      for (int trial = 0; trial < 5; ++trial) person.push_back(own + 0.5 * random.normal());
    }
    const Interval i = bootstrap_median(people, random, 300);
    held += i.low <= 10.0 && 10.0 <= i.high ? 1 : 0;
    width += (i.high - i.low) / kStudies;
  }
  EXPECT_GE(held, 0.90 * kStudies);
  EXPECT_LE(held, 0.99 * kStudies);
  // Median of 25 normals: standard error about 1.25 / 5. 125 independent trials would give 0.49.
  EXPECT_GT(width, 0.75);
  EXPECT_LT(width, 1.20);
}

TEST(Bootstrap, IsTheSameForTheSameSeedAndDiffersForAnother) {
  ByPerson people;
  Random values(3);
  for (int i = 0; i < 40; ++i) people.push_back({values.normal(), values.normal()});
  Random a(9), b(9), c(10);
  const Interval i = bootstrap_median(people, a), j = bootstrap_median(people, b),
                 k = bootstrap_median(people, c, 100);
  EXPECT_EQ(i.low, j.low);
  EXPECT_EQ(i.high, j.high);
  EXPECT_NE(i.low, k.low);
}

TEST(Bootstrap, ReachesInfinityWhenFailuresMayDecide) {
  Random random(1);
  const Interval i = bootstrap_median(people_of({1, 2, 3, kFailed, kNaN}), random);
  EXPECT_LE(i.low, 2.0);
  EXPECT_EQ(i.high, kFailed);
}

TEST(Bootstrap, OfNobodyIsNaN) {
  Random random(1);
  EXPECT_TRUE(std::isnan(bootstrap_median({}, random).low));
  EXPECT_TRUE(std::isnan(bootstrap_median({{}, {}}, random).high));
  EXPECT_TRUE(std::isnan(bootstrap_median({{1}}, random, 0).low));
}

TEST(Bootstrap, LeavesOutPeopleWithoutValues) {
  ByPerson people, gaps;
  Random values(2);
  for (int i = 0; i < 9; ++i) {
    people.push_back({values.normal(), values.normal()});
    gaps.push_back({});
    gaps.push_back(people.back());
  }
  Random a(4), b(4);
  const Interval i = bootstrap_median(people, a), j = bootstrap_median(gaps, b);
  EXPECT_EQ(i.low, j.low);
  EXPECT_EQ(i.high, j.high);
}

TEST(ComparePaired, GivesRatioOfMediansAndShareHelped) {
  Random random(1);
  const Paired p = compare_paired({{1, 3}, {2}, {8}, {5}}, {{4}, {2}, {6, 8}, {10}}, random);
  EXPECT_EQ(p.people, 4u);
  EXPECT_EQ(p.ratio, 3.0 / 6.0);  // 1 2 3 5 8 against 2 4 6 8 10
  EXPECT_EQ(p.helped, (1.0 + 0.5 + 0.0 + 1.0) / 4.0);
}

TEST(ComparePaired, ResamplesBothModesTogether) {
  // Everybody takes exactly half as long: only the same people on both sides keep the ratio.
  ByPerson with, without;
  for (int i = 1; i <= 15; ++i) {
    with.push_back({0.5 * i});
    without.push_back({1.0 * i});
  }
  Random random(2);
  const Paired p = compare_paired(with, without, random);
  EXPECT_EQ(p.ratio, 0.5);
  EXPECT_EQ(p.ratio_95.low, 0.5);
  EXPECT_EQ(p.ratio_95.high, 0.5);
  EXPECT_NEAR(p.helped_95.low, 0.7820, 5e-5);  // 0.025^(1/15): all of fifteen are not everybody
  EXPECT_EQ(p.helped_95.high, 1.0);
}

TEST(ComparePaired, ShareHelpedHasTheExactInterval) {
  ByPerson with, without;
  for (int i = 0; i < 100; ++i) {
    with.push_back({i < 60 ? 1.0 : 3.0});
    without.push_back({2.0});
  }
  Random random(3);
  const Paired p = compare_paired(with, without, random);
  EXPECT_NEAR(p.helped, 0.6, 1e-12);
  EXPECT_NEAR(p.helped_95.low, 0.4972, 5e-5);
  EXPECT_NEAR(p.helped_95.high, 0.6967, 5e-5);
}

TEST(ComparePaired, FailureIsTheWorstRankInBothModes) {
  Random random(1);
  const Paired tie = compare_paired({{kFailed}}, {{kFailed}}, random);
  EXPECT_EQ(tie.ratio, 1.0);
  EXPECT_EQ(tie.helped, 0.5);
  EXPECT_EQ(tie.ratio_95.high, 1.0);
  const Paired helped = compare_paired({{3}}, {{kFailed}}, random);
  EXPECT_EQ(helped.ratio, 0.0);
  EXPECT_EQ(helped.helped, 1.0);
  const Paired hurt = compare_paired({{kNaN}}, {{3}}, random);
  EXPECT_EQ(hurt.ratio, kFailed);
  EXPECT_EQ(hurt.helped, 0.0);
}

TEST(ComparePaired, ComparesOnlyPeopleWithValuesInBothModes) {
  Random a(6), b(6);
  const Paired p = compare_paired({{1}, {}, {9}, {3}, {7}}, {{2}, {5}, {}, {4}}, a);
  const Paired q = compare_paired({{1}, {3}}, {{2}, {4}}, b);
  EXPECT_EQ(p.people, 2u);
  EXPECT_EQ(p.ratio, 2.0 / 3.0);
  EXPECT_EQ(p.helped, 1.0);
  EXPECT_EQ(p.ratio_95.low, q.ratio_95.low);
  EXPECT_EQ(p.ratio_95.high, q.ratio_95.high);
}

TEST(ComparePaired, OfNobodyIsNaN) {
  Random random(1);
  const Paired p = compare_paired({{1}}, {}, random);
  EXPECT_EQ(p.people, 0u);
  for (const double v : {p.ratio, p.helped, p.ratio_95.low, p.ratio_95.high, p.helped_95.low}) {
    EXPECT_TRUE(std::isnan(v));
  }
}

TEST(CohortSpread, OfCohortsOfOneCoversThePeople) {
  std::vector<double> values;
  for (int i = 0; i <= 100; ++i) values.push_back(i);
  Random random(1);
  const Interval i = cohort_spread(people_of(values), 1, random, 20000);
  EXPECT_NEAR(i.low, 2.5, 1.0);
  EXPECT_NEAR(i.high, 97.5, 1.0);
}

TEST(CohortSpread, HasAtLeastOnePersonInACohort) {
  Random a(1), b(1);
  const ByPerson people = people_of({1, 2, 3, 4, 5});
  EXPECT_EQ(cohort_spread(people, 0, a).high, 5.0);
  EXPECT_EQ(cohort_spread(people, 1, b).high, 5.0);
}

TEST(CohortSpread, DrawsWithoutReplacement) {
  // Of four people, three: 1 2 3, 1 2 4, 1 3 4 or 2 3 4. With replacement 1 would be a median too.
  Random random(1);
  const Interval i = cohort_spread(people_of({1, 2, 3, 4}), 3, random);
  EXPECT_EQ(i.low, 2.0);
  EXPECT_EQ(i.high, 3.0);
}

TEST(CohortSpread, IsAPointWhenTheCohortIsEverybody) {
  for (const std::size_t size : {3u, 4u, 100u}) {
    Random random(1);
    const Interval i = cohort_spread(people_of({1, 2, 9}), size, random);
    EXPECT_EQ(i.low, 2.0);
    EXPECT_EQ(i.high, 2.0);
  }
  Random random(1);
  EXPECT_EQ(cohort_spread({{1, 5, 6}}, 7, random).low, 5.0);
  EXPECT_TRUE(std::isnan(cohort_spread({}, 7, random).low));
}

TEST(CohortSpread, NarrowsAsCohortsGrow) {
  ByPerson people;
  Random random(8);
  for (int i = 0; i < 300; ++i) people.push_back({random.normal(), random.normal()});
  const Interval seven = cohort_spread(people, 7, random), many = cohort_spread(people, 63, random);
  // A median of 7 people spreads about three times as far as one of 63.
  const double ratio = (seven.high - seven.low) / (many.high - many.low);
  EXPECT_GT(ratio, 2.4);
  EXPECT_LT(ratio, 4.2);
}

// Against the sum of the binomial's own terms: at the interval's ends the count found, and what is
// further away, has a probability of 2.5 %.
double at_least(int count, int of, double p) {
  double sum = 0.0;
  for (int k = count; k <= of; ++k) {
    const double ways = std::lgamma(of + 1) - std::lgamma(k + 1) - std::lgamma(of - k + 1);
    sum += std::exp(ways + k * std::log(p) + (of - k) * std::log1p(-p));
  }
  return sum;
}

TEST(Statistics, TheIntervalOfAShareIsExact) {
  for (const auto& [count, of] : std::vector<std::pair<int, int>>{
           {1, 7}, {5, 10}, {9, 10}, {59, 60}, {60, 100}, {180, 200}, {3, 1600}}) {
    const Interval i = share_95(count, static_cast<std::size_t>(of));
    EXPECT_NEAR(at_least(count, of, i.low), 0.025, 1e-9) << count << " of " << of;
    EXPECT_NEAR(1.0 - at_least(count + 1, of, i.high), 0.025, 1e-9) << count << " of " << of;
  }
  EXPECT_NEAR(share_95(60, 60).low, std::pow(0.025, 1.0 / 60.0), 1e-12);
  EXPECT_EQ(share_95(60, 60).high, 1.0);
  EXPECT_EQ(share_95(0, 60).low, 0.0);
  EXPECT_NEAR(share_95(0, 60).high, 1.0 - std::pow(0.025, 1.0 / 60.0), 1e-12);
  EXPECT_TRUE(std::isnan(share_95(0, 0).low));
}

TEST(Statistics, AShareOfPeopleHasAnIntervalThatNarrowsWithTheirNumber) {
  const auto share = [](std::size_t people) {
    std::vector<bool> nine_of_ten(people, true);
    for (std::size_t i = 0; i < people; i += 10) nine_of_ten[i] = false;
    return share_of(nine_of_ten);
  };
  EXPECT_DOUBLE_EQ(share(10).value, 0.9);
  EXPECT_DOUBLE_EQ(share(200).value, 0.9);
  EXPECT_NEAR(share(10).value_95.low, 0.5550, 5e-5);
  EXPECT_NEAR(share(10).value_95.high, 0.9975, 5e-5);
  EXPECT_NEAR(share(200).value_95.low, 0.8498, 5e-5);
  EXPECT_NEAR(share(200).value_95.high, 0.9378, 5e-5);
}

}  // namespace
}  // namespace handrail
