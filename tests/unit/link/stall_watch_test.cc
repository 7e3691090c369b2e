// A loop that stands still is noticed once, and its going on once.
#include "server/link/stall_watch.h"

#include <gtest/gtest.h>

namespace handrail {
namespace {

using Change = StallWatch::Change;

TEST(StallWatch, SaysOnceThatALoopStandsStillAndOnceThatItRunsAgain) {
  StallWatch watch;
  EXPECT_EQ(watch.step(100, 100), Change::kNone);
  EXPECT_EQ(watch.step(101, 100), Change::kStalled);
  EXPECT_EQ(watch.step(150, 100), Change::kNone);
  EXPECT_TRUE(watch.stalled());
  EXPECT_EQ(watch.step(151, 160), Change::kRunsAgain);
  EXPECT_EQ(watch.stood_for(), 50);
  EXPECT_FALSE(watch.stalled());
  EXPECT_EQ(watch.step(152, 160), Change::kNone);
}

}  // namespace
}  // namespace handrail
