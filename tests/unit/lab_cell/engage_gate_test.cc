// Over which links both daemons engage, and what is said of the others.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "server/session/ladder.h"
#include "tests/unit/lab_cell/two_sides.h"

namespace handrail {
namespace {

// 50 +- 20 ms each way and 10 % loss. `overtake`: each datagram takes its own way; else a queue
// keeps their order.
LinkFaults far_away(bool overtake) {
  LinkFaults faults;
  faults.delay = 50 * kMillisecond;
  faults.jitter = 20 * kMillisecond;
  faults.loss = 0.1;
  faults.reorder = overtake ? 1.0 : 0.0;
  return faults;
}

LinkFaults losing(double share) {
  LinkFaults faults;
  faults.loss = share;
  return faults;
}

// The number before `words` in `text`; -1: there is none.
double figure(const std::string& text, const std::string& words) {
  const std::size_t at = text.find(" " + words);
  if (at == std::string::npos) return -1.0;
  const std::size_t start = text.rfind(' ', at - 1) + 1;
  return std::strtod(text.c_str() + start, nullptr);
}

class EngageGateTest : public ::testing::TestWithParam<std::uint64_t> {
 protected:
  void set_network(const LinkFaults& faults) { sides.to_slave() = sides.to_master() = faults; }
  std::string why() { return sides.status().ledger().sentence(); }

  TwoSides sides{Presence::kNone, TwoSides::kArm, GetParam()};
};

INSTANTIATE_TEST_SUITE_P(Seeds, EngageGateTest, ::testing::Range<std::uint64_t>(1, 6));

TEST_P(EngageGateTest, ASteadyFarLinkEngagesWithinOneAndAHalfSecondsAndThenAtAnyMoment) {
  for (const bool overtake : {true, false}) {
    TwoSides far(Presence::kNone, TwoSides::kArm, GetParam());
    far.to_slave() = far.to_master() = far_away(overtake);
    // The second that the link must have been heard, and six ways of at most 70 ms each.
    const Nanos start = TwoSides::now();
    far.run(200 * kMillisecond);  // until the slave is heard
    ASSERT_EQ(far.ask("engage: true"), "done: ");
    EXPECT_LT(TwoSides::now() - start, 1500 * kMillisecond);
    for (int i = 0; i < 20; ++i) {
      far.run(100 * kMillisecond);
      ASSERT_EQ(far.ask("disengage: true"), "done: ");
      far.run(200 * kMillisecond);
      const Nanos again = TwoSides::now();
      ASSERT_EQ(far.ask("engage: true"), "done: ") << far.status().ledger().sentence();
      EXPECT_LT(TwoSides::now() - again, 500 * kMillisecond);
    }
  }
}

TEST_P(EngageGateTest, SixtyPercentLossIsRefusedWithFiguresBothWays) {
  set_network(losing(0.6));
  sides.run(1500 * kMillisecond);
  const std::string answer = sides.ask("engage: true");
  ASSERT_TRUE(answer.starts_with("refused: the link is not good enough: ")) << answer;
  for (const std::string& text : {answer, why()}) {
    for (const char* way : {"the way here", "the way to the slave"}) {
      const std::string words = std::string("% lost on ") + way;
      EXPECT_NEAR(figure(text, words), 60.0, 10.0) << text;
      EXPECT_NE(text.find(words + ", at most 25 % in 1 s is asked"), std::string::npos) << text;
    }
  }
}

TEST_P(EngageGateTest, ABadWayToTheSlaveAloneIsRefusedAndNamed) {
  sides.to_slave() = losing(0.4);
  sides.run(1500 * kMillisecond);
  const std::string answer = sides.ask("engage: true");
  ASSERT_TRUE(answer.starts_with("refused: the link is not good enough: ")) << answer;
  EXPECT_NEAR(figure(answer, "% lost on the way to the slave"), 40.0, 8.0) << answer;
  EXPECT_EQ(answer.find("way here"), std::string::npos) << answer;
}

// In every 200 ms a gap of 45 ms: the arm would stand for an eighth of the time, and the loss alone
// is not too much.
TEST_P(EngageGateTest, GapsThatHoldTheArmForAnEighthOfTheTimeAreRefusedWithFigures) {
  sides.weather = [&] {
    sides.to_slave().loss = sides.now() / kMillisecond % 200 < 45 ? 1.0 : 0.0;
  };
  sides.run(1500 * kMillisecond);
  const std::string answer = sides.ask("engage: true");
  ASSERT_TRUE(answer.starts_with("refused: the link is not good enough: ")) << answer;
  const std::string words = "% of the time nothing new at the slave for over 20 ms";
  EXPECT_NEAR(figure(answer, words), 12.5, 1.5) << answer;
  EXPECT_NE(answer.find(words + ", at most 9 % in 1 s is asked"), std::string::npos) << answer;
  EXPECT_EQ(answer.find("lost"), std::string::npos) << answer;
}

TEST_P(EngageGateTest, BurstsThatLoseFortyPercentAreRefusedWithFigures) {
  LinkFaults bursts;
  bursts.burst_leave = 1.0 / 20.0;  // of 20 ms in the mean
  bursts.burst_enter = 0.4 / 0.6 / 20.0;
  set_network(bursts);
  sides.run(1500 * kMillisecond);
  const std::string answer = sides.ask("engage: true");
  ASSERT_TRUE(answer.starts_with("refused: the link is not good enough: ")) << answer;
  EXPECT_GT(std::max(figure(answer, "% lost on the way here"),
                     figure(answer, "% lost on the way to the slave")),
            25.0)
      << answer;
}

TEST_P(EngageGateTest, GapsOfThreeHundredMillisecondsAreRefusedWithFigures) {
  sides.weather = [&] { sides.cut_network(sides.now() / kMillisecond % 1000 < 300); };
  sides.run(1500 * kMillisecond);
  const std::string answer = sides.ask("engage: true");
  ASSERT_TRUE(answer.starts_with("refused: ")) << answer;
  const std::string words = "s without a gap of over 200 ms, 1 s is asked";
  // The desk gives up at any moment, also in a gap.
  const std::string text =
      sides.now() / kMillisecond % 1000 < 500 ? (sides.run(500 * kMillisecond), why()) : answer;
  EXPECT_GT(figure(text, words), 0.0) << text;
  EXPECT_LT(figure(text, words), 0.71) << text;
}

}  // namespace
}  // namespace handrail
