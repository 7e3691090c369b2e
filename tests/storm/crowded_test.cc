#include "tests/storm/crowded.h"

#include <gmock/gmock.h>

#include <cmath>

namespace handrail::storm {
namespace {

using ::testing::HasSubstr;

// Pairs of windows without and with the crowd; stops of 0.01 to 10 ms in steps of 0.01.
std::vector<CrowdedWindow> windows() {
  std::vector<CrowdedWindow> out;
  for (int pair = 0; pair < 4; ++pair) {
    CrowdedWindow without, with;
    without.haptic_us = 100.0;
    without.bare_us = 50.0;
    with.bare_us = 45.0 + 10.0 * pair;  // 5 less, then 5, 15 and 25 more
    without.robot_us = 900.0;
    without.taken_ms = {3.0};
    with.crowded = with.disk_held = true;
    with.haptic_us = 100.0 + 10.0 * pair;  // 0, 10, 20 and 30 more
    with.robot_us = pair == 0 ? 9000.0 : 880.0;
    for (int i = 1; i <= 250; ++i) with.taken_ms.push_back(0.01 * (i + 250 * pair));
    out.push_back(without);
    out.push_back(with);
  }
  return out;
}

TEST(Crowded, FiguresAreRanksAndMediansOfDifferences) {
  const CrowdedFigures f = figures_of(windows());
  EXPECT_EQ(f.taken.count, 1000u);
  EXPECT_NEAR(f.taken.median, 5.00, 1e-9);
  EXPECT_NEAR(f.taken.p99, 9.90, 1e-9);
  EXPECT_NEAR(f.taken.p999, 9.99, 1e-9);
  EXPECT_NEAR(f.taken.worst, 10.00, 1e-9);
  EXPECT_EQ(f.calm_taken.count, 4u);
  EXPECT_NEAR(f.haptic.median, 15.0, 1e-9);
  EXPECT_NEAR(f.bare.median, 10.0, 1e-9);
  EXPECT_NEAR(f.robot.median, -20.0, 1e-9);
  EXPECT_TRUE(f.reached());
}

// Of ten values the second smallest and the second largest enclose the median in 97.9 % of all
// samples, the third in 89.1 % (binomial with one half); of five the ends do in 93.8 %.
TEST(Crowded, TheIntervalIsThatOfTheSignTest) {
  std::vector<CrowdedWindow> out;
  for (int pair = 0; pair < 10; ++pair) {
    CrowdedWindow without, with;
    with.crowded = true;
    with.haptic_us = 10.0 * pair;
    out.insert(out.end(), {without, with});
  }
  EXPECT_EQ(figures_of(out).haptic.low, 10.0);
  EXPECT_EQ(figures_of(out).haptic.median, 45.0);
  EXPECT_EQ(figures_of(out).haptic.high, 80.0);
  out.resize(2 * 6);
  EXPECT_EQ(figures_of(out).haptic.low, 0.0);
  EXPECT_EQ(figures_of(out).haptic.high, 50.0);
  out.resize(2 * 5);
  EXPECT_TRUE(std::isinf(figures_of(out).haptic.high));
}

TEST(Crowded, EachFigureCanMissItsBound) {
  auto slow = windows();
  slow[1].taken_ms.push_back(10.5);  // two of 1002 are more than 0.1 %
  slow[1].taken_ms.push_back(10.5);
  EXPECT_FALSE(figures_of(slow).reached());
  auto late = windows();
  for (auto& w : late) w.haptic_us += w.crowded ? 40.0 : 0.0;
  EXPECT_FALSE(figures_of(late).reached());
  EXPECT_FALSE(figures_of({}).reached());
  auto quick_disk = windows();
  quick_disk[3].disk_held = false;
  EXPECT_FALSE(figures_of(quick_disk).reached());
  CrowdedOutcome outcome;
  outcome.windows = late;
  EXPECT_THAT(for_people(outcome), HasSubstr("NOT REACHED"));
  EXPECT_THAT(to_json({}, outcome), HasSubstr("\"reached\": false"));
}

}  // namespace
}  // namespace handrail::storm
