#include "server/slave/silence_watch.h"

#include <gtest/gtest.h>

#include <vector>

namespace handrail {
namespace {

class SilenceWatchTest : public ::testing::Test {
 protected:
  // Each 10 ms for so long.
  void silent(bool is_silent, Nanos time) {
    for (const Nanos until = now + time; now < until; now += 10 * kMillisecond) {
      if (const auto line = watch.step(now, is_silent)) {
        EXPECT_TRUE(line->bad);
        lines.push_back(line->text);
      }
    }
  }

  Nanos now = 100 * kSecond;
  int asked = 0;
  std::optional<Obstacle> answer;
  std::vector<std::string> lines;
  SilenceWatch watch{"the arm", [this] {
                       ++asked;
                       return answer;
                     }};
};

const Obstacle kServos{"the servos are off", "handrail robot on", false, Reason::kRobotServosOff};
const Obstacle kKey{"it is in TEACH", "turn its key", false, Reason::kRobotTeaching};

TEST_F(SilenceWatchTest, WhileTheArmAnswersNobodyIsAsked) {
  answer = kServos;
  silent(false, 20 * kSecond);
  EXPECT_EQ(asked, 0);
  EXPECT_EQ(watch.reason(), Reason::kNone);
}

TEST_F(SilenceWatchTest, TheCauseIsSaidOnceAndAskedForEachFiveSeconds) {
  answer = kServos;
  silent(true, 60 * kSecond);
  EXPECT_EQ(asked, 12);
  EXPECT_EQ(lines,
            std::vector<std::string>{"the arm is silent: the servos are off; handrail robot on"});
  EXPECT_EQ(watch.reason(), Reason::kRobotServosOff);
  answer = kKey;
  silent(true, 10 * kSecond);
  EXPECT_EQ(lines.size(), 2u);
  EXPECT_EQ(watch.reason(), Reason::kRobotTeaching);
}

TEST_F(SilenceWatchTest, WhatIsNotKnownYetIsAskedForUntilItIs) {
  silent(true, kSecond);
  EXPECT_EQ(asked, 100);
  EXPECT_TRUE(lines.empty());
  EXPECT_EQ(watch.reason(), Reason::kNone);
  answer = kServos;
  silent(true, kSecond);
  EXPECT_EQ(asked, 101);
  EXPECT_EQ(lines.size(), 1u);
}

TEST_F(SilenceWatchTest, WhatWasAskedBeforeItAnsweredIsNoNews) {
  silent(true, kSecond);
  silent(false, kSecond);
  answer = kServos;
  silent(false, kSecond);
  EXPECT_TRUE(lines.empty());
  EXPECT_EQ(watch.reason(), Reason::kNone);
  answer.reset();
  silent(true, 10 * kSecond);
  silent(false, kSecond);
  silent(true, kSecond);
  answer = kServos;
  silent(true, kSecond);
  EXPECT_TRUE(lines.empty()) << "asked in the silence before this one";
  silent(true, 10 * kSecond);
  EXPECT_EQ(lines.size(), 1u);
}

TEST_F(SilenceWatchTest, WhenItAnswersAgainTheCauseIsGoneAndTheNextSilenceHasItsOwn) {
  answer = kServos;
  silent(true, 10 * kSecond);
  silent(false, 10 * kMillisecond);
  EXPECT_EQ(watch.reason(), Reason::kNone);
  const int before = asked;
  // Another silence at once does not ask more often.
  silent(true, kSecond);
  EXPECT_LE(asked, before + 1);
  silent(true, 10 * kSecond);
  EXPECT_EQ(lines.size(), 2u);
}

TEST_F(SilenceWatchTest, WithNobodyToAskItSaysNothing) {
  SilenceWatch alone("the arm", {});
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE(alone.step(now += kSecond, true));
}

}  // namespace
}  // namespace handrail
