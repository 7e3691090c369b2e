#include "server/link/busy_poll.h"

#include <gtest/gtest.h>

namespace handrail {
namespace {

constexpr Nanos us(int n) { return n * kMicrosecond; }
constexpr Nanos kStep = us(1);

// For how long of `span` a thread polls whose ticks come every `period`, the other side heard
// `silence` before each.
Nanos polled(BusyPoll& poll, Nanos span, Nanos period, Nanos silence) {
  Nanos out = 0, ticked = -period;
  for (Nanos now = 0; now < span; now += kStep) {
    if (now - ticked >= period) poll.ticked(ticked = now, now - silence);
    if (poll.polls(now)) out += kStep;
  }
  return out;
}

TEST(BusyPoll, IsOffUntilItIsTurnedOn) {
  BusyPoll poll;
  EXPECT_EQ(polled(poll, kSecond, kSendPeriod, 0), 0);
  poll.turn_on();
  EXPECT_GT(polled(poll, kSecond, kSendPeriod, 0), 0);
}

TEST(BusyPoll, SleepsATenthOfEachTickThenPolls) {
  BusyPoll poll;
  poll.turn_on();
  poll.ticked(us(5000), us(4500));
  EXPECT_FALSE(poll.polls(us(5000)));
  EXPECT_FALSE(poll.polls(us(5099)));
  EXPECT_TRUE(poll.polls(us(5100)));
  EXPECT_TRUE(poll.polls(us(5999)));
  EXPECT_FALSE(poll.polls(us(6000))) << "a tick that is late is slept for";
}

// Linux stops real-time threads that take 950 ms of a second.
TEST(BusyPoll, NeverTakesAsMuchOfASecondAsARealTimeThreadMay) {
  for (const Nanos period : {us(500), us(990), us(1000), us(1500), us(20000)}) {
    BusyPoll poll;
    poll.turn_on();
    EXPECT_LE(polled(poll, kSecond, period, 0), 910 * kMillisecond) << period;
  }
}

TEST(BusyPoll, SleepsWhileTheOtherSideIsSilent) {
  BusyPoll poll;
  poll.turn_on();
  EXPECT_GT(polled(poll, kSecond, kSendPeriod, us(20000)), kSecond / 2);
  EXPECT_EQ(polled(poll, kSecond, kSendPeriod, us(20001)), 0);
  EXPECT_EQ(polled(poll, kSecond, kSendPeriod, kForever), 0) << "it was never heard";
}

}  // namespace
}  // namespace handrail
