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
  EXPECT_EQ(a.received(), 3);
}

TEST(Arrivals, WindowEdgesAreExact) {
  Arrivals a = started(1);
  EXPECT_EQ(a.add(100), Reject::kNone);  // 1 is the oldest remembered
  EXPECT_EQ(a.add(1), Reject::kDuplicate);
  EXPECT_EQ(a.received(), 2);
  EXPECT_EQ(a.add(101), Reject::kNone);  // 1 has left
  EXPECT_EQ(a.add(1), Reject::kStale);
  EXPECT_EQ(a.received(), 2);
  EXPECT_EQ(a.add(201), Reject::kNone);  // a jump past the window forgets all
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
