// Lines cut down to what can be seen.
#include "server/lab/figure/geometry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>

#include "server/base/random.h"

namespace handrail::figure {

void PrintTo(const Point& p, std::ostream* out) { *out << "(" << p.x << ", " << p.y << ")"; }

namespace {

using testing::ElementsAre;
constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kEndless = std::numeric_limits<double>::infinity();
constexpr Rect kFrame = {0, 0, 100, 50};

double off(const Point& p, const Point& a, const Point& b) {
  double least = kEndless;  // by trying, not by the formula under test
  for (int i = 0; i <= 1000; ++i) {
    const double t = i / 1000.0;
    least = std::min(least, std::hypot(p.x - std::lerp(a.x, b.x, t), p.y - std::lerp(a.y, b.y, t)));
  }
  return least;
}

TEST(Thin, AStraightLineKeepsItsEnds) {
  std::vector<Point> line;
  for (int i = 0; i <= 1000; ++i) line.push_back({0.1 * i, 0.2 * i});
  EXPECT_THAT(thin(line), ElementsAre(Point{0, 0}, Point{100, 200}));
}

TEST(Thin, KeepsCornersAndTurnsBack) {
  EXPECT_THAT(thin({{0, 0}, {5, 0}, {10, 0}, {10, 5}, {10, 10}}),
              ElementsAre(Point{0, 0}, Point{10, 0}, Point{10, 10}));
  EXPECT_THAT(thin({{0, 0}, {9, 0}, {4, 0}}), ElementsAre(Point{0, 0}, Point{9, 0}, Point{4, 0}));
  EXPECT_THAT(thin({{0, 0}, {9, 0}, {0, 0}}), ElementsAre(Point{0, 0}, Point{9, 0}, Point{0, 0}));
}

TEST(Thin, DropsOnlyWhatIsWithinTheTolerance) {
  std::vector<Point> circle;
  for (int i = 0; i <= 5000; ++i) {
    circle.push_back({100 * std::cos(i * 1e-3), 100 * std::sin(i * 1e-3)});
  }
  const std::vector<Point> few = thin(circle, 0.05);
  EXPECT_LT(few.size(), 160u);
  EXPECT_GT(few.size(), 70u);  // an arc of 0.063 rad stands 0.05 off its chord: 80 of them
  std::size_t k = 0;
  double worst = 0.0;
  for (const Point& p : circle) {
    if (k + 2 < few.size() && p == few[k + 1]) ++k;
    worst = std::max(worst, off(p, few[k], few[k + 1]));
  }
  EXPECT_LE(worst, 0.05 + 1e-6);
}

TEST(Thin, LeavesShortLinesAlone) {
  EXPECT_TRUE(thin({}).empty());
  EXPECT_THAT(thin({{1, 2}}), ElementsAre(Point{1, 2}));
  EXPECT_THAT(thin({{1, 2}, {1, 2}}), ElementsAre(Point{1, 2}, Point{1, 2}));
}

TEST(VisibleRuns, BreakWhereAPointIsNotFinite) {
  for (const Point gap : {Point{20, kNoNumber}, Point{kEndless, 5}, Point{kNoNumber, -kEndless}}) {
    const auto runs = visible_runs({{0, 5}, {10, 5}, gap, {30, 5}, {40, 5}}, kFrame);
    ASSERT_EQ(runs.size(), 2u);
    EXPECT_THAT(runs[0], ElementsAre(Point{0, 5}, Point{10, 5}));
    EXPECT_THAT(runs[1], ElementsAre(Point{30, 5}, Point{40, 5}));
  }
}

TEST(VisibleRuns, MakeALonePointADot) {
  const auto runs = visible_runs({{0, kNoNumber}, {10, 5}, {20, kNoNumber}, {300, 5}}, kFrame);
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_THAT(runs[0], ElementsAre(Point{10, 5}, Point{10, 5}));
}

TEST(VisibleRuns, EndAtTheFrame) {
  const auto runs = visible_runs({{50, 25}, {150, 25}, {150, 40}, {50, 40}}, kFrame);
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_THAT(runs[0], ElementsAre(Point{50, 25}, Point{100, 25}));
  EXPECT_THAT(runs[1], ElementsAre(Point{100, 40}, Point{50, 40}));
}

TEST(VisibleRuns, CrossTheFrameBetweenTwoPointsOutside) {
  const auto runs = visible_runs({{-10, 5}, {110, 65}}, kFrame);
  ASSERT_EQ(runs.size(), 1u);
  ASSERT_EQ(runs[0].size(), 2u);
  EXPECT_NEAR(runs[0][0].x, 0, 1e-9);
  EXPECT_NEAR(runs[0][0].y, 10, 1e-9);
  EXPECT_NEAR(runs[0][1].x, 80, 1e-9);
  EXPECT_NEAR(runs[0][1].y, 50, 1e-9);
  EXPECT_TRUE(visible_runs({{-10, 45}, {10, 65}}, kFrame).empty()) << "past the corner";
}

TEST(VisibleRuns, StayInTheFrameHoweverFarThePoints) {
  Random random(4);
  std::vector<Point> wild;
  for (int i = 0; i < 2000; ++i) {
    const double size = std::pow(10.0, 100.0 * random.uniform());
    wild.push_back({size * random.normal(), size * random.normal()});
    wild.push_back({100 * random.uniform(), 50 * random.uniform()});
  }
  const auto runs = visible_runs(wild, kFrame);
  EXPECT_GT(runs.size(), 1000u);
  for (const auto& run : runs) {
    EXPECT_GE(run.size(), 2u);
    for (const Point& p : run) EXPECT_TRUE(kFrame.contains(p)) << p.x << " " << p.y;
  }
}

}  // namespace
}  // namespace handrail::figure
