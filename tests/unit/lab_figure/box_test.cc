// What a box plot shows of samples worked out by hand.
#include "server/lab/figure/box.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace handrail::figure {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
constexpr double kFailed = std::numeric_limits<double>::infinity();

TEST(BoxStats, WhiskersEndAtTheFarthestValueWithinReach) {
  // Quartiles 2, 3, 4: reach from -1 to 7, both included.
  const BoxStats box = box_stats({3, 2, 4, -1, 7, 2, 3, 4, 3});
  EXPECT_EQ(box.q1, 2.0);
  EXPECT_EQ(box.median, 3.0);
  EXPECT_EQ(box.q3, 4.0);
  EXPECT_EQ(box.low, -1.0);
  EXPECT_EQ(box.high, 7.0);
  EXPECT_THAT(box.outliers, IsEmpty());
  EXPECT_EQ(box.count, 9u);
}

TEST(BoxStats, ValuesBeyondReachAreOutliers) {
  const BoxStats box = box_stats({3, 2, 4, -1.1, 7.1, 2, 3, 4, 3});
  EXPECT_EQ(box.low, 2.0);
  EXPECT_EQ(box.high, 4.0);
  EXPECT_THAT(box.outliers, ElementsAre(-1.1, 7.1));
}

TEST(BoxStats, WhiskersNeverEndInsideTheBox) {
  // q3 is 25.75, and 100 is beyond 62.875: no value is left between.
  const BoxStats box = box_stats({1, 1, 1, 100});
  EXPECT_EQ(box.q3, 25.75);
  EXPECT_EQ(box.high, 25.75);
  EXPECT_THAT(box.outliers, ElementsAre(100.0));
}

TEST(BoxStats, FailuresAreTheWorstRanks) {
  const BoxStats box = box_stats({1, 2, 3, 4, kFailed, std::nan(""), kFailed});
  EXPECT_EQ(box.q1, 2.5);
  EXPECT_EQ(box.median, 4.0);
  EXPECT_EQ(box.q3, kFailed);
  EXPECT_EQ(box.low, 1.0);
  EXPECT_EQ(box.failures, 3u);
  EXPECT_EQ(box.count, 7u);
  EXPECT_THAT(box.outliers, IsEmpty());
}

TEST(BoxStats, WithMostlyFailuresThereIsNoBox) {
  const BoxStats box = box_stats({5, kFailed, kFailed, kFailed, kFailed});
  EXPECT_EQ(box.q1, kFailed);
  EXPECT_TRUE(std::isnan(box.low));
  EXPECT_THAT(box.outliers, ElementsAre(5.0));
}

TEST(BoxStats, OfNothingIsNaN) {
  const BoxStats box = box_stats({});
  EXPECT_EQ(box.count, 0u);
  for (const double v : {box.q1, box.median, box.q3, box.low, box.high}) {
    EXPECT_TRUE(std::isnan(v));
  }
}

}  // namespace
}  // namespace handrail::figure
