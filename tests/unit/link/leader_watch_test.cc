#include "server/link/leader_watch.h"

#include <gtest/gtest.h>

namespace handrail {
namespace {

using Change = LeaderWatch::Change;

class LeaderWatchTest : public ::testing::Test {
 protected:
  Change refused(const char* leader) {
    link.refused_at = now;
    link.refusal = {1, false, fixed_text<LeaderName>(leader), kSecond};
    return step(kMillisecond);
  }
  Change answered() {
    link.received_at = now;
    return step(kMillisecond);
  }
  Change step(Nanos after) { return watch.step(link, now += after); }

  LeaderWatch watch;
  LinkSnapshot link;
  Nanos now = 1000 * kSecond;
};

TEST_F(LeaderWatchTest, WhoeverLeadsIsSaidOnceHoweverRarelyWeAreTold) {
  EXPECT_EQ(step(kSecond), Change::kNone);
  EXPECT_EQ(refused("process 1"), Change::kLed);
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(step(3 * kRefusalStands), Change::kNone);
    EXPECT_EQ(refused("process 1"), Change::kNone) << "gap " << i;
  }
}

TEST_F(LeaderWatchTest, AnotherLeaderIsSaidWithAndWithoutAGap) {
  EXPECT_EQ(refused("process 1"), Change::kLed);
  EXPECT_EQ(refused("process 3"), Change::kLed);
  EXPECT_EQ(refused("process 3"), Change::kNone);
  EXPECT_EQ(step(3 * kRefusalStands), Change::kNone);
  EXPECT_EQ(refused("process 1"), Change::kLed);
}

TEST_F(LeaderWatchTest, AnAnswerIsSaidOnceAndTheSameLeaderAgainAfterIt) {
  EXPECT_EQ(answered(), Change::kNone) << "nobody was said to lead";
  EXPECT_EQ(refused("process 1"), Change::kLed);
  EXPECT_EQ(answered(), Change::kAnswers);
  EXPECT_EQ(answered(), Change::kNone);
  EXPECT_EQ(refused("process 1"), Change::kLed);
  EXPECT_EQ(step(3 * kRefusalStands), Change::kNone);
  EXPECT_EQ(answered(), Change::kAnswers);
}

}  // namespace
}  // namespace handrail
