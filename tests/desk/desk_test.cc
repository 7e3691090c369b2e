// The judges of handrail-desk, and what it does in a second or two.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/desk/loop_trial.h"
#include "tests/desk/results.h"
#include "tests/desk/seats.h"
#include "tests/desk/spacenavd_soak.h"
#include "tests/support/real_spacenavd.h"

namespace handrail::desk {
namespace {

using ::testing::HasSubstr;

TEST(Soak, AFrameBearsItsNumber) {
  for (const std::uint64_t number : {0ul, 1ul, 299ul, 300ul, 89'999ul, 90'000ul, 26'999'999ul}) {
    const auto frame = frame_of(number);
    std::array<std::int32_t, 6> told{};
    for (std::size_t i = 0; i < 6; ++i) told[i] = i % 2 == 0 ? frame[i] : -frame[i];
    EXPECT_EQ(number_in(told), static_cast<std::int64_t>(number));
    told[2] = 3;
    EXPECT_EQ(number_in(told), -1) << "no frame of ours";
  }
}

TEST(Soak, IsWholeOnlyWithoutAnyLoss) {
  SoakFigures good;
  good.pushed = 100;
  good.told = good.heard = 90;
  EXPECT_TRUE(whole(good)) << "what spacenavd keeps to itself is no loss of ours";
  for (auto field : {&SoakFigures::heard, &SoakFigures::astray, &SoakFigures::invalid}) {
    SoakFigures bad = good;
    ++(bad.*field);
    EXPECT_FALSE(whole(bad));
    EXPECT_THAT(soak_text({}, bad), HasSubstr("FAILED"));
    EXPECT_THAT(soak_json({}, bad), HasSubstr("\"whole\":false"));
  }
  EXPECT_FALSE(whole(SoakFigures())) << "nothing came";
}

TEST(Soak, TheRealDaemonForTwoSecondsLosesNone) {
  if (!test::RealSpacenavd::installed()) GTEST_SKIP() << test::RealSpacenavd::kMissing;
  const auto figures = soak({.seconds = 2.0, .rate = 500.0}, [] { return false; });
  ASSERT_TRUE(figures) << figures.message();
  EXPECT_TRUE(whole(*figures)) << soak_text({}, *figures);
  EXPECT_GT(figures->told, figures->pushed / 2);
  EXPECT_GE(figures->pushed, 900u);
  const auto stopped = soak({.seconds = 60.0, .rate = 500.0}, [] { return true; });
  ASSERT_TRUE(stopped) << stopped.message();
  EXPECT_EQ(stopped->pushed, 0u);
}

LoopSeries series(double late, double work, std::uint64_t valid = 1000,
                  std::uint64_t engaged = 1000) {
  LoopSeries out{"one", "nothing", "", {}};
  LoopRound round;
  for (int i = 0; i < 1000; ++i) {
    round.late.push_back(late + (i == 500 ? 1000.0 : 0.0));
    round.work.push_back(work);
  }
  round.valid = valid;
  round.engaged = engaged;
  out.rounds.assign(3, round);
  return out;
}

TEST(Loop, FiguresAreOfAllTicksAndGrowthOfTheSameRounds) {
  const LoopSeries first = series(50.0, 5.0);
  LoopSeries other = series(80.0, 25.0, 750, 500);
  other.rounds[1].late.assign(1000, 5000.0);  // one round in which something else ran
  const LoopFigures f = loop_figures(other, first);
  EXPECT_EQ(f.late.median, 80.0);
  EXPECT_EQ(f.late.worst, 5000.0);
  EXPECT_EQ(f.work.most, 25.0);
  EXPECT_NEAR(f.late_grows, 30.0, 1e-9);
  EXPECT_NEAR(f.work_grows, 20.0, 1e-9);
  EXPECT_EQ(f.valid, 0.75);
  EXPECT_EQ(f.engaged, 0.5);
}

TEST(Loop, MoreThanFiftyMicrosecondsOrAwayIsSaid) {
  EXPECT_TRUE(within_growth({series(50.0, 5.0), series(99.0, 54.0)}));
  EXPECT_FALSE(within_growth({series(50.0, 5.0), series(101.0, 5.0)}));
  EXPECT_FALSE(within_growth({series(50.0, 5.0), series(50.0, 56.0)}));
  EXPECT_FALSE(within_growth({series(50.0, 5.0), series(50.0, 5.0, 980)}));
  EXPECT_FALSE(within_growth({series(50.0, 5.0), series(50.0, 5.0, 1000, 800)}));
  EXPECT_FALSE(within_growth({}));
  LoopSeries missing{"two", "nothing", "it is not installed", {}};
  EXPECT_TRUE(within_growth({series(50.0, 5.0), missing}));
  EXPECT_THAT(loop_table({series(50.0, 5.0), missing}),
              HasSubstr("not tried: it is not installed"));
  EXPECT_THAT(loop_json({series(50.0, 5.0), series(101.0, 5.0)}), HasSubstr("\"within\":false}"));
}

// Each driver is read and drives the arm; how fast is measured, and not asserted.
TEST(Loop, EachDriverIsReadAndDrives) {
  const auto tried = try_loops({.rounds = 1, .seconds = 0.5, .devices = {}},
                               [](const std::string&) { return true; });
  ASSERT_TRUE(tried) << tried.message();
  ASSERT_EQ(tried->size(), seat_rows().size());
  for (const LoopSeries& one : *tried) {
    if (one.device == "spacemouse" && !test::RealSpacenavd::installed()) continue;
    ASSERT_EQ(one.missing, "") << one.device;
    const LoopFigures f = loop_figures(one, tried->front());
    EXPECT_GT(f.valid, 0.9) << one.device;
    EXPECT_GT(f.engaged, 0.5) << one.device;
    const bool pushes = one.device != "spacemouse" && one.device != "gamepad";
    EXPECT_EQ(f.pushed > 0.5, pushes) << one.device;
  }
  const auto none = try_loops({.rounds = 1, .seconds = 0.5, .devices = {}},
                              [](const std::string&) { return false; });
  EXPECT_EQ(none.message(), "stopped");
}

}  // namespace
}  // namespace handrail::desk
