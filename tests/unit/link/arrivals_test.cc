#include "server/link/arrivals.h"

#include <gtest/gtest.h>

namespace handrail {
namespace {

Arrivals started(std::uint64_t first) {
  Arrivals arrivals;
  arrivals.restart(first);
  return arrivals;
}

TEST(Arrivals, OnlyARisingSequenceIsFresh) {
  Arrivals a = started(10);
  EXPECT_EQ(a.add(11), Reject::kNone);
  EXPECT_EQ(a.add(11), Reject::kDuplicate);
  EXPECT_EQ(a.add(10), Reject::kDuplicate);
  EXPECT_EQ(a.add(9), Reject::kStale);
  EXPECT_EQ(a.add(15), Reject::kNone);
  EXPECT_EQ(a.newest(), 15u);
}

TEST(Arrivals, ALateOneIsStaleOnceAndThenADuplicate) {
  Arrivals a = started(1);
  EXPECT_EQ(a.add(5), Reject::kNone);
  EXPECT_EQ(a.add(3), Reject::kStale);
  EXPECT_EQ(a.add(3), Reject::kDuplicate);
  EXPECT_EQ(a.under_way(), 3u);
  EXPECT_EQ(a.received(), 1) << "of 1 and 2; 3 came as late as any, so 4 may still come";
  EXPECT_DOUBLE_EQ(a.loss_share(), 0.5);
}

// Sequences 1 to `count`; every odd one comes 40 later, but for those in `lost`.
template <typename Lost>
Arrivals after_two_ways(std::uint64_t count, Lost lost) {
  Arrivals a = started(0);
  for (std::uint64_t n = 1; n <= count; ++n) {
    if (n % 2 == 0 && !lost(n)) {
      EXPECT_EQ(a.add(n), Reject::kNone);
    }
    if (n > 40 && n % 2 == 1 && !lost(n - 40)) {
      EXPECT_EQ(a.add(n - 40), Reject::kStale);
    }
  }
  return a;
}

TEST(Arrivals, WhatComesBehindANewerOneIsNotLost) {
  const Arrivals a = after_two_ways(1000, [](std::uint64_t) { return false; });
  EXPECT_EQ(a.newest(), 1000u);
  EXPECT_EQ(a.under_way(), 40u);
  EXPECT_EQ(a.received(), 100);
  EXPECT_DOUBLE_EQ(a.loss_share(), 0.0);
}

TEST(Arrivals, WhatNeverComesIsLostHoweverLateTheRestIs) {
  const Arrivals a = after_two_ways(1000, [](std::uint64_t n) { return n % 10 < 2; });
  EXPECT_EQ(a.received(), 80);
  EXPECT_NEAR(a.loss_share(), 0.2, 1e-12);
}

TEST(Arrivals, HowLateTheyComeIsForgottenAfterAThousand) {
  Arrivals a = started(1);
  (void)a.add(31);
  EXPECT_EQ(a.add(2), Reject::kStale);
  for (std::uint64_t n = 32; n < 1000; ++n) (void)a.add(n);
  EXPECT_EQ(a.under_way(), 30u);
  (void)a.add(1000);
  EXPECT_EQ(a.under_way(), 0u);
  (void)a.add(1031);
  EXPECT_EQ(a.add(1011), Reject::kStale);
  EXPECT_EQ(a.under_way(), 21u);
  (void)a.add(5000);  // over more than all that is remembered
  EXPECT_EQ(a.under_way(), 0u);
}

TEST(Arrivals, BeyondTwoHundredNothingIsWaitedFor) {
  Arrivals a = started(1);
  (void)a.add(300);
  EXPECT_EQ(a.add(99), Reject::kStale);
  EXPECT_EQ(a.under_way(), 0u);
  EXPECT_EQ(a.add(99), Reject::kStale) << "it was not taken note of";
  EXPECT_EQ(a.add(100), Reject::kStale);
  EXPECT_EQ(a.under_way(), 201u);
  EXPECT_EQ(a.received(), 1) << "of 1 to 99";
  EXPECT_EQ(a.add(100), Reject::kDuplicate);
  EXPECT_EQ(a.received(), 1);
}

TEST(Arrivals, AJumpIsALossOfAllThatWasLeftOut) {
  Arrivals a = started(1);
  for (std::uint64_t n = 2; n <= 500; ++n) (void)a.add(n);
  (void)a.add(561);
  EXPECT_EQ(a.received(), 40);
  EXPECT_DOUBLE_EQ(a.loss_share(), 0.6);
}

TEST(Arrivals, WindowEdgesAreExact) {
  Arrivals a = started(1);
  EXPECT_EQ(a.add(100), Reject::kNone);
  EXPECT_EQ(a.received(), 2);
  EXPECT_EQ(a.add(101), Reject::kNone);  // 1 is not judged any more
  EXPECT_EQ(a.received(), 2);
  EXPECT_EQ(a.add(301), Reject::kNone);  // and the oldest remembered
  EXPECT_EQ(a.add(1), Reject::kDuplicate);
  EXPECT_EQ(a.add(302), Reject::kNone);
  EXPECT_EQ(a.add(1), Reject::kStale);
  EXPECT_EQ(a.add(603), Reject::kNone);  // a jump past all that is remembered
  EXPECT_EQ(a.add(302), Reject::kStale);
  EXPECT_EQ(a.received(), 1);
}

TEST(Arrivals, TheLastSequenceIsTakenOnceAndNothingFollows) {
  Arrivals a = started(UINT64_MAX - 1);
  EXPECT_EQ(a.add(UINT64_MAX), Reject::kNone);
  EXPECT_EQ(a.add(UINT64_MAX), Reject::kDuplicate);
  EXPECT_EQ(a.add(UINT64_MAX - 1), Reject::kDuplicate);
  EXPECT_EQ(a.add(0), Reject::kStale);
  EXPECT_EQ(a.add(1), Reject::kStale);
  EXPECT_EQ(a.newest(), UINT64_MAX);
}

TEST(Arrivals, AJumpAcrossTheWholeRangeIsTaken) {
  Arrivals a = started(1);
  EXPECT_EQ(a.add(UINT64_MAX), Reject::kNone);
  EXPECT_EQ(a.received(), 1);
  EXPECT_DOUBLE_EQ(a.loss_share(), 0.99);
}

TEST(Arrivals, LossCountsGapsOfTheLastHundred) {
  Arrivals a = started(1);
  EXPECT_DOUBLE_EQ(a.loss_share(), 0.0);
  for (std::uint64_t n = 2; n <= 400; ++n) {
    if (n % 4 != 0) (void)a.add(n);
  }
  (void)a.add(401);
  EXPECT_EQ(a.received(), 75);
  EXPECT_DOUBLE_EQ(a.loss_share(), 0.25);
}

TEST(Arrivals, LossOfAYoungSessionIsOverItsOwnSequences) {
  Arrivals a = started(50);
  (void)a.add(53);
  EXPECT_DOUBLE_EQ(a.loss_share(), 0.5);
  EXPECT_EQ(a.add(49), Reject::kStale);
  EXPECT_DOUBLE_EQ(a.loss_share(), 0.5);
}

TEST(Arrivals, NothingIsLostBeforeTheFirst) { EXPECT_DOUBLE_EQ(Arrivals{}.loss_share(), 0.0); }

}  // namespace
}  // namespace handrail
