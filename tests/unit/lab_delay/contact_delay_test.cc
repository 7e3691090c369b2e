// Surfaces felt over delay.
#include "server/lab/delay/contact_delay.h"

#include <gtest/gtest.h>

#include "server/lab/delay/delay_command.h"

namespace handrail {
namespace {

TEST(ContactDelay, TheModelIsFeltAsStiffAsTheDeviceHoldsAtTheSecondTouch) {
  const DelayFigures f = measure_delay({50e3, 200.0, 0.0, 0.0, true, 1});
  ASSERT_TRUE(f.engaged);
  EXPECT_FALSE(f.ended);
  EXPECT_GE(f.touch[1].felt, 0.9 * f.true_stiffness);
  EXPECT_GE(f.touch[0].held, 0.9 * f.true_stiffness);
  EXPECT_LT(f.touch[1].error, f.touch[0].error);
  EXPECT_TRUE(f.stable());
  EXPECT_LT(f.off_mm, 0.5);
}

TEST(ContactDelay, TheSpringIsFeltNoStifferThanItIs) {
  const DelayFigures f = measure_delay({50e3, 200.0, 0.0, 0.0, false, 1});
  ASSERT_TRUE(f.engaged);
  EXPECT_LE(f.touch[1].held, 200.0);
  EXPECT_GT(f.touch[1].held, 50.0);
  EXPECT_GT(f.touch[1].error, 0.3);
}

// Half of the time the arm holds. What it touches stands still the while.
TEST(ContactDelay, HoldsDoNotTakeTheSurfaceFromTheHand) {
  const DelayFigures f = measure_delay({50e3, 500.0, 100.0, 0.3, true, 3});
  ASSERT_TRUE(f.engaged);
  EXPECT_GT(f.held_share, 0.2);
  EXPECT_LT(f.held_share, 1.0);
  EXPECT_GE(f.touch[1].felt, 0.9 * f.true_stiffness);
  EXPECT_TRUE(f.stable()) << f.touch[0].swing << " N, " << f.touch[1].swing << " N";
}

TEST(ContactDelay, TheSameCaseGivesTheSameFigures) {
  const DelayCase of{1e3, 50.0, 0.0, 0.3, true, 7};
  EXPECT_EQ(delay_json({{of, measure_delay(of)}}), delay_json({{of, measure_delay(of)}}));
}

TEST(ContactDelay, EveryCaseCanBeSent) {
  for (const DelayCase& of : delay_cases(false, 1)) {
    EXPECT_LE(of.jitter_ms, 0.5 * of.round_trip_ms);
    EXPECT_LE(of.loss, 0.5);
  }
  EXPECT_EQ(delay_cases(true, 1).size(), 16u);
}

}  // namespace
}  // namespace handrail
