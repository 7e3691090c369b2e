// What of a device's readings no hand does.
#include "devices/input/leap_guard.h"

#include <gtest/gtest.h>

#include <string>

namespace handrail {
namespace {

constexpr Nanos kTurn = kMillisecond;

// Read at once, a turn after the last.
std::optional<Leap> read(LeapGuard& guard, const Vec3& p_M, int turn) {
  return guard.next(p_M, turn * kTurn, turn * kTurn);
}

TEST(LeapGuard, NothingThatAHandDoesIsALeap) {
  LeapGuard guard(Vec3::Zero());
  for (int i = 0; i < 100; ++i) {
    EXPECT_FALSE(read(guard, Vec3(9.99e-3, -9.99e-3, 9.99e-3) * i, i)) << i;
  }
}

TEST(LeapGuard, WhatIsFasterIsToldWithAxisWayAndTime) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double way : {10.01e-3, -0.3}) {
      LeapGuard guard(Vec3::Zero());
      const Vec3 p(0.05, -0.04, 0.03);
      ASSERT_FALSE(read(guard, p, 1));
      const auto leap = read(guard, p + way * Vec3::Unit(axis), 2);
      ASSERT_TRUE(leap);
      EXPECT_EQ(leap->axis, axis);
      EXPECT_NEAR(leap->way, way, 1e-12);
      EXPECT_EQ(leap->time, kTurn);
    }
  }
}

TEST(LeapGuard, TheTimeIsFromBeforeTheLastReadingToAfterThisOne) {
  LeapGuard slow_last(Vec3::Zero());
  (void)slow_last.next(Vec3::Zero(), 0, 5 * kTurn);
  EXPECT_FALSE(slow_last.next(Vec3::Constant(0.0599), 5 * kTurn, 6 * kTurn));
  LeapGuard slow_now(Vec3::Zero());
  (void)slow_now.next(Vec3::Zero(), 0, 0);
  EXPECT_FALSE(slow_now.next(Vec3::Constant(0.0599), kTurn, 6 * kTurn));
  const auto leap = slow_now.next(Vec3::Constant(0.1201), 7 * kTurn, 7 * kTurn);
  ASSERT_TRUE(leap) << "from the beginning of the last, a turn after the first";
  EXPECT_EQ(leap->time, 6 * kTurn);
}

TEST(LeapGuard, ReadingsThatMayBeOldHaveLonger) {
  LeapGuard guard(Vec3::Zero(), 4 * kTurn);
  ASSERT_FALSE(read(guard, Vec3::Zero(), 0));
  EXPECT_FALSE(read(guard, Vec3(0.0499, 0.0, 0.0), 1));
  const auto leap = read(guard, Vec3(-0.0003, 0.0, 0.0), 2);
  ASSERT_TRUE(leap);
  EXPECT_EQ(leap->time, 5 * kTurn);
}

TEST(LeapGuard, ASingleCountIsNone) {
  LeapGuard guard(Vec3(0.02, 0.0, 0.0));
  ASSERT_FALSE(read(guard, Vec3::Zero(), 0));
  EXPECT_FALSE(read(guard, Vec3(0.02, 0.0, 0.0), 1));
  EXPECT_TRUE(read(guard, Vec3(-0.02, 0.0, 0.0), 2)) << "two are 20 mm at least";
  EXPECT_TRUE(read(guard, Vec3(-0.02, 0.02, 0.0), 3)) << "of X";
}

TEST(LeapGuard, TheNextIsJudgedFromWhereItLeapt) {
  LeapGuard guard(Vec3::Zero());
  ASSERT_FALSE(read(guard, Vec3::Zero(), 0));
  ASSERT_TRUE(read(guard, Vec3(0.1, 0.0, 0.0), 1));
  EXPECT_FALSE(read(guard, Vec3(0.1, 0.0, 0.0), 2));
  EXPECT_TRUE(read(guard, Vec3::Zero(), 3));
}

TEST(LeapGuard, ResetTheNextReadingIsTheFirst) {
  LeapGuard guard(Vec3::Zero());
  ASSERT_FALSE(read(guard, Vec3(0.1, 0.0, 0.0), 0)) << "nor is the very first one";
  guard.reset();
  EXPECT_FALSE(read(guard, Vec3::Zero(), 1));
  EXPECT_TRUE(read(guard, Vec3(0.1, 0.0, 0.0), 2));
}

TEST(LeapGuard, ItsTextNamesWaySpeedAndWhatAHandDoes) {
  EXPECT_EQ(text_of(leap_text("its axis X leapt by", {0, -0.0283, 1'132'000})),
            "its axis X leapt by -28.3 mm, in 1.13 ms: 25 m/s, and at most 10 are a hand's; look "
            "at its cable");
}

TEST(LeapGuard, WhatIsToBeDoneNextFollowsItAndIsCutToWhatFits) {
  const auto trouble = fixed_text<DeviceTrouble>("it leapt");
  EXPECT_EQ(text_of(and_then(trouble, "then move it")), "it leapt; then move it");
  EXPECT_EQ(text_of(and_then(trouble, "")), "it leapt");
  const std::string cut(text_of(and_then(trouble, std::string(300, 'x'))));
  EXPECT_EQ(cut, "it leapt; " + std::string(199 - 10, 'x'));
}

}  // namespace
}  // namespace handrail
