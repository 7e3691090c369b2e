#include "server/base/pacer.h"

#include <gtest/gtest.h>

#include "server/base/clock.h"

namespace handrail {
namespace {

constexpr Nanos kStart = 77 * kSecond;
constexpr Nanos kPeriod = kMillisecond;

TEST(Pacer, TicksOnAbsoluteTimesHoweverLateEachWakes) {
  Pacer pacer(kPeriod, kStart);
  for (int i = 1; i <= 1000; ++i) {
    ASSERT_EQ(pacer.due(), kStart + i * kPeriod);
    EXPECT_EQ(pacer.woke(pacer.due() + 150 * kMicrosecond), 0);
  }
  EXPECT_EQ(pacer.ticks(), 1000u);
  EXPECT_EQ(pacer.overruns(), 0u);
  EXPECT_EQ(pacer.lateness().max(), 150 * kMicrosecond);
}

TEST(Pacer, MissedPeriodsAreCountedAndNotCaughtUp) {
  Pacer pacer(kPeriod, kStart);
  EXPECT_EQ(pacer.woke(kStart + 4 * kPeriod + 300), 3);
  EXPECT_EQ(pacer.due(), kStart + 5 * kPeriod);
  EXPECT_EQ(pacer.ticks(), 1u);
  EXPECT_EQ(pacer.overruns(), 1u);
  EXPECT_EQ(pacer.missed(), 3u);
}

TEST(Pacer, AWholePeriodLateIsAnOverrunAndLessIsNot) {
  Pacer pacer(kPeriod, kStart);
  EXPECT_EQ(pacer.woke(pacer.due() + kPeriod - 1), 0);
  EXPECT_EQ(pacer.due(), kStart + 2 * kPeriod);
  EXPECT_EQ(pacer.woke(pacer.due() + kPeriod), 1);
  EXPECT_EQ(pacer.due(), kStart + 4 * kPeriod);
}

TEST(Pacer, OverrunsInARowEndWithATickOnTime) {
  Pacer pacer(kPeriod, kStart);
  for (std::uint64_t i = 1; i <= 6; ++i) {
    (void)pacer.woke(pacer.due() + kPeriod);
    EXPECT_EQ(pacer.consecutive_overruns(), i);
  }
  (void)pacer.woke(pacer.due());
  EXPECT_EQ(pacer.consecutive_overruns(), 0u);
  EXPECT_EQ(pacer.overruns(), 6u);
}

TEST(Pacer, AnEarlyWakeUpCountsAsOnTime) {
  Pacer pacer(kPeriod, kStart);
  EXPECT_EQ(pacer.woke(pacer.due() - 10), 0);
  EXPECT_EQ(pacer.due(), kStart + 2 * kPeriod);
  EXPECT_EQ(pacer.lateness().max(), 0);
  EXPECT_EQ(pacer.woke(pacer.due() - 3 * kPeriod), 0);
  EXPECT_EQ(pacer.due(), kStart + 3 * kPeriod);
}

TEST(Pacer, ALongSleepOfTheMachineIsOneOverrun) {
  Pacer pacer(kPeriod, kStart);
  EXPECT_EQ(pacer.woke(kStart + 86'400 * kSecond), 86'400'000 - 1);
  EXPECT_EQ(pacer.overruns(), 1u);
  EXPECT_GT(pacer.due(), kStart + 86'400 * kSecond);
}

TEST(SleepUntil, NeverReturnsEarly) {
  const Nanos until = monotonic_now() + 2 * kMillisecond;
  sleep_until(until);
  EXPECT_GE(monotonic_now(), until);
  sleep_until(until - kSecond);  // passed: returns
}

}  // namespace
}  // namespace handrail
