// One direction of the link: what is on its way arrives in time, however much of it there is.
#include "server/lab/cell/wire.h"

#include <gtest/gtest.h>

#include "tests/support/no_allocation.h"

namespace handrail {
namespace {

constexpr Nanos kPeriod = kMillisecond;

TEST(Wire, BringsNothingBeforeTheTransitTimeHasPassed) {
  Wire<int> wire(3 * kPeriod, kPeriod);
  int newest = 0;
  wire.send(7, 10 * kPeriod);
  EXPECT_FALSE(wire.receive(13 * kPeriod - 1, newest));
  EXPECT_EQ(wire.age(13 * kPeriod - 1), kForever);
  EXPECT_TRUE(wire.receive(13 * kPeriod, newest));
  EXPECT_EQ(newest, 7);
  EXPECT_EQ(wire.age(13 * kPeriod), 0);
}

TEST(Wire, GivesEachStateOnceAndTellsItsAge) {
  Wire<int> wire(0, kPeriod);
  int newest = 0;
  wire.send(1, 0);
  EXPECT_TRUE(wire.receive(0, newest));
  EXPECT_FALSE(wire.receive(5 * kPeriod, newest));
  EXPECT_EQ(newest, 1);
  EXPECT_EQ(wire.age(5 * kPeriod), 5 * kPeriod);
}

TEST(Wire, ASlowReaderGetsTheNewestThatHasArrived) {
  Wire<int> wire(2 * kPeriod, kPeriod);
  int newest = 0;
  for (int i = 0; i <= 100; ++i) wire.send(i, i * kPeriod);
  EXPECT_TRUE(wire.receive(100 * kPeriod, newest));
  EXPECT_EQ(newest, 98);
  EXPECT_TRUE(wire.receive(101 * kPeriod, newest));
  EXPECT_EQ(newest, 99);
  EXPECT_TRUE(wire.receive(200 * kPeriod, newest));
  EXPECT_EQ(newest, 100);
  EXPECT_EQ(wire.age(200 * kPeriod), 98 * kPeriod);
}

// A reader at any phase, transit times that are and are not whole numbers of sends.
TEST(Wire, NoTransitIsTooLong) {
  for (const Nanos transit : {Nanos{0}, kPeriod / 3, kPeriod, 7 * kPeriod / 2, 2000 * kPeriod}) {
    for (const int every : {1, 7}) {
      for (const Nanos phase : {Nanos{0}, kPeriod / 2, kPeriod - 1}) {
        Wire<int> wire(transit, kPeriod);
        int newest = -1;
        for (int i = 0; i < 5000; ++i) {
          wire.send(i, i * kPeriod);
          if (i % every != 0) continue;
          const Nanos now = i * kPeriod + phase;
          wire.receive(now, newest);
          const Nanos sent_by = now - transit;
          ASSERT_EQ(newest, sent_by < 0 ? -1 : static_cast<int>(sent_by / kPeriod))
              << "transit " << transit << ", every " << every << ", send " << i;
        }
      }
    }
  }
}

TEST(Wire, DoesNotAllocate) {
  Wire<int> wire(3 * kPeriod, kPeriod);
  int newest = 0;
  test::NoAllocation guard("a wire");
  for (int i = 0; i < 100; ++i) {
    wire.send(i, i * kPeriod);
    wire.receive(i * kPeriod, newest);
  }
}

}  // namespace
}  // namespace handrail
