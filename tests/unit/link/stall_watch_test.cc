#include "server/link/stall_watch.h"

#include <gtest/gtest.h>

namespace handrail {
namespace {

constexpr Nanos ms(int n) { return n * kMillisecond; }

// A loop that makes its state every millisecond, but for its stalls, and the lines about it.
struct Loop {
  void runs_until(Nanos end) {
    for (; now < end; now += ms(1)) look(made = now);
  }
  void stands_until(Nanos end) {
    for (; now < end; now += ms(1)) look(made);
  }
  void look(Nanos of) {
    if (const auto line = watch.step(now, of + kStateStands, "haptic")) {
      lines.push_back(*line);
      when.push_back(now);
    }
  }
  StallWatch watch;
  Nanos now = ms(1000), made = now;
  std::vector<std::string> lines;
  std::vector<Nanos> when;
};

TEST(StallWatch, ALoopThatRunsIsNotMentioned) {
  Loop loop;
  loop.runs_until(ms(3000));
  loop.stands_until(ms(3019));
  EXPECT_FALSE(loop.watch.stalled());
  loop.runs_until(ms(4000));
  EXPECT_TRUE(loop.lines.empty());
}

TEST(StallWatch, AStallIsToldWithItsTrueLength) {
  Loop loop;
  loop.runs_until(ms(2000));
  loop.stands_until(ms(2060));
  EXPECT_TRUE(loop.watch.stalled());
  loop.runs_until(ms(5000));
  EXPECT_FALSE(loop.watch.stalled());
  ASSERT_EQ(loop.lines.size(), 1u);
  EXPECT_EQ(loop.lines[0],
            "the haptic loop runs again: it stood still for 61 ms; the machine is overloaded, or "
            "was paused");
}

// A loop that is about to wait says for how long that is good.
TEST(StallWatch, ALoopThatSaysThatItWaitsDoesNotStandStill) {
  Loop loop;
  loop.runs_until(ms(2000));
  for (int k = 0; k < 20; ++k) {
    const Nanos from = loop.now;
    for (; loop.now < from + ms(107); loop.now += ms(1)) loop.look(from + ms(107));
    loop.runs_until(from + ms(1000));
  }
  EXPECT_TRUE(loop.lines.empty());
}

// The whole program is paused, and its loop is the first to run again.
TEST(StallWatch, AStallThatEndedBeforeAnybodyLookedIsToldToo) {
  Loop loop;
  loop.runs_until(ms(2000));
  loop.now += ms(300);
  loop.runs_until(ms(5000));
  ASSERT_EQ(loop.lines.size(), 1u);
  EXPECT_EQ(loop.lines[0],
            "the haptic loop runs again: it stood still for 301 ms; the machine is overloaded, or "
            "was paused");
}

TEST(StallWatch, ManyStallsAreOneLineASecond) {
  Loop loop;
  for (int k = 0; k < 40; ++k) {  // one of 30 to 69 ms every 100 ms
    loop.runs_until(ms(2000 + 100 * k));
    loop.stands_until(ms(2030 + 101 * k));
  }
  loop.runs_until(ms(8000));
  ASSERT_GE(loop.lines.size(), 4u);
  ASSERT_LE(loop.lines.size(), 6u);
  for (std::size_t i = 1; i < loop.when.size(); ++i) {
    EXPECT_GE(loop.when[i] - loop.when[i - 1], kSecond);
  }
  EXPECT_NE(loop.lines[1].find("10 times, for up to 4"), std::string::npos) << loop.lines[1];
}

TEST(StallWatch, ALoopThatStandsForASecondIsToldMeanwhileOnce) {
  Loop loop;
  loop.runs_until(ms(2000));
  loop.stands_until(ms(9000));
  ASSERT_EQ(loop.lines.size(), 1u);
  EXPECT_EQ(loop.lines[0], "the haptic loop stands still: nothing is sent, the arm holds");
  EXPECT_LT(loop.when[0], ms(3010));
  loop.runs_until(ms(9500));
  ASSERT_EQ(loop.lines.size(), 2u);
  EXPECT_NE(loop.lines[1].find("for 7001 ms"), std::string::npos) << loop.lines[1];
}

TEST(StallWatch, NeitherDoesALineAboutTheEndFollowWithinTheSecond) {
  Loop loop;
  loop.runs_until(ms(2000));
  loop.stands_until(ms(3100));  // the line that it stands has just been said
  loop.runs_until(ms(6000));
  ASSERT_EQ(loop.lines.size(), 2u);
  EXPECT_GE(loop.when[1] - loop.when[0], kSecond);
  EXPECT_NE(loop.lines[1].find("for 1101 ms"), std::string::npos) << loop.lines[1];
}

}  // namespace
}  // namespace handrail
