// Locks of gears and the spring back to neutral.
#include "server/effects/detent.h"

#include <gtest/gtest.h>

#include <cmath>

#include "server/effects/return_spring.h"
#include "tests/unit/effects/effect_samples.h"

namespace handrail {
namespace {

using test::kTick;
using test::Mass;
using Kind = EffectEvent::Kind;

const WallRegion kFreeSpace = test::free_region();

Detent gears() { return Detent({Vec2(-0.02, 0.03), Vec2(0.0, 0.03)}, 4e-3, 4.0); }

EffectTick feel(Detent& detent, const Vec2& hand) {
  EffectTick tick;
  tick.force = detent.force(test::at(hand, kFreeSpace), tick);
  return tick;
}

TEST(Detent, PullsTowardItsPlaceMostAtHalfTheRadiusAndNotBeyondIt) {
  Detent detent = gears();
  EXPECT_NEAR(feel(detent, {1e-3, 0.03}).force.x(), -2.0, 1e-9);
  EXPECT_NEAR(feel(detent, {0.0, 0.032}).force.y(), -4.0, 1e-9);
  EXPECT_NEAR(feel(detent, {-0.02, 0.027}).force.y(), 2.0, 1e-9);
  EXPECT_EQ(feel(detent, {0.0, 0.0341}).force.norm(), 0.0);
  EXPECT_EQ(feel(detent, {0.0, 0.03}).force.norm(), 0.0);
}

TEST(Detent, PlacesMayDifferInReachAndStrength) {
  Detent detent({Vec2(-0.02, 0.03), Vec2(0.0, 0.03)}, std::vector<double>{2e-3, 8e-3},
                std::vector<double>{3.0, 4.0});
  EXPECT_NEAR(feel(detent, {-0.021, 0.03}).force.x(), 3.0, 1e-9);
  EXPECT_TRUE(feel(detent, {-0.0209, 0.03}).locked);
  EXPECT_FALSE(feel(detent, {-0.0221, 0.03}).locked);
  EXPECT_EQ(feel(detent, {-0.0221, 0.03}).force.norm(), 0.0);
  EXPECT_NEAR(feel(detent, {0.004, 0.03}).force.x(), -4.0, 1e-9);
  EXPECT_EQ(detent.locked(), 1);
  EXPECT_NEAR(feel(detent, {0.007, 0.03}).force.x(), -1.0, 1e-9);
  EXPECT_EQ(detent.stiffness(), 3000.0);
}

TEST(Detent, TheForceIsContinuousAllTheWayThrough) {
  Detent detent = gears();
  Vec2 last = Vec2::Zero();
  for (int i = 0; i <= 4000; ++i) {
    const Vec2 f = feel(detent, {-0.02 + 1e-5 * (i - 2000), 0.0303}).force;
    EXPECT_LT((f - last).norm(), 2000.0 * 1e-5 * 1.01) << i;
    last = f;
  }
}

TEST(Detent, GivesBackAllItTookAroundALoop) {
  Detent detent = gears();
  double energy = 0.0, deepest = 0.0;
  Vec2 last(0.006, 0.03);
  for (int i = 1; i <= 100'000; ++i) {
    const double a = 2.0 * 3.14159265358979 * i / 100'000.0;
    const Vec2 x(0.006 * std::cos(a), 0.03 + 0.002 * std::sin(2.0 * a));
    energy += feel(detent, 0.5 * (x + last)).force.dot(x - last);
    deepest = std::max(deepest, energy);
    last = x;
  }
  EXPECT_NEAR(energy, 0.0, 1e-6);
  EXPECT_NEAR(deepest, 0.5 * 4.0 * 4e-3, 1e-4) << "the potential's depth";
}

TEST(Detent, LocksWithinHalfTheRadiusAndOpensBeyondIt) {
  Detent detent = gears();
  EXPECT_EQ(feel(detent, {0.003, 0.03}).event_count, 0);
  EffectTick tick = feel(detent, {0.0019, 0.03});
  ASSERT_EQ(tick.event_count, 1);
  EXPECT_EQ(tick.events[0].kind, Kind::kLocked);
  EXPECT_EQ(tick.events[0].place, 1);
  EXPECT_TRUE(tick.locked);
  tick = feel(detent, {0.0039, 0.03});
  EXPECT_EQ(tick.event_count, 0);
  EXPECT_TRUE(tick.locked);
  tick = feel(detent, {0.0041, 0.03});
  ASSERT_EQ(tick.event_count, 1);
  EXPECT_EQ(tick.events[0].kind, Kind::kUnlocked);
  EXPECT_EQ(tick.events[0].place, 1);
  EXPECT_FALSE(tick.locked);
  EXPECT_EQ(detent.locked(), -1);
}

TEST(Detent, ALeverPressedPastItsGearIntoTheWallStaysInGear) {
  Detent detent = gears();
  feel(detent, {0.0, 0.03});
  // The aisle ends 3 mm past the gear; the hand is 2 mm deep in the wall.
  EffectInput in = test::at({0.0, 0.035}, kFreeSpace);
  in.proxy = Vec2(0.0, 0.033);
  EffectTick tick;
  detent.force(in, tick);
  EXPECT_EQ(tick.event_count, 0);
  EXPECT_TRUE(tick.locked);
  // Nor does it lock through a wall.
  EXPECT_FALSE(feel(detent, {0.0, 0.02}).locked);
  in.hand = Vec2(0.0, 0.03);
  in.proxy = Vec2(0.0, 0.027);
  EffectTick through;
  detent.force(in, through);
  EXPECT_FALSE(through.locked);
}

TEST(Detent, AHandThatJumpsFromLockToLockTellsBoth) {
  Detent detent = gears();
  feel(detent, {0.0, 0.03});
  const EffectTick tick = feel(detent, {-0.02, 0.03});
  ASSERT_EQ(tick.event_count, 2);
  EXPECT_EQ(tick.events[0].kind, Kind::kUnlocked);
  EXPECT_EQ(tick.events[0].place, 1);
  EXPECT_EQ(tick.events[1].kind, Kind::kLocked);
  EXPECT_EQ(tick.events[1].place, 0);
}

TEST(Detent, AMassLetGoInItDoesNotSwingHigher) {
  Detent detent({Vec2::Zero()}, 4e-3, 4.0);
  Mass mass;
  mass.x = 1.9e-3;
  double late = 0.0, widest = 0.0;
  for (int i = 0; i < 60'000; ++i) {
    EffectInput in = test::at({mass.x, 0.0}, kFreeSpace);
    in.velocity = Vec2(mass.v, 0.0);
    EffectTick tick;
    mass.step(detent.force(in, tick).x());
    widest = std::max(widest, std::abs(mass.x));
    if (i > 50'000) late = std::max(late, std::abs(mass.x));
  }
  EXPECT_LE(widest, 1.95e-3);
  EXPECT_LT(late, 1e-5);
}

TEST(ReturnSpring, PullsToItsPointUpToItsForceOutsideLocks) {
  ReturnSpring spring(Vec2::Zero(), 100.0, 2.0, 3e-3);
  EffectTick tick;
  Vec2 f = Vec2::Zero();
  for (int i = 0; i < 60; ++i) f = spring.force(test::at({0.01, 0.0}, kFreeSpace), tick);
  EXPECT_NEAR(f.x(), -1.0, 1e-12);
  f = spring.force(test::at({0.0, -0.05}, kFreeSpace), tick);
  EXPECT_NEAR(f.y(), 2.0, 1e-12);
  tick.locked = true;
  double last = 2.0;
  for (int i = 0; i < 60; ++i) {
    f = spring.force(test::at({0.0, -0.05}, kFreeSpace), tick);
    EXPECT_LT(std::abs(f.norm() - last), 0.05);
    last = f.norm();
  }
  EXPECT_EQ(last, 0.0);
}

TEST(ReturnSpring, TellsOnceThatTheHandIsBack) {
  ReturnSpring spring(Vec2::Zero(), 100.0, 2.0, 3e-3);
  const auto events = [&spring](double x) {
    EffectTick tick;
    spring.force(test::at({x, 0.0}, kFreeSpace), tick);
    return tick.event_count == 1 && tick.events[0].kind == Kind::kReturned;
  };
  EXPECT_FALSE(events(0.0)) << "it never was away";
  EXPECT_FALSE(events(0.007));
  EXPECT_FALSE(events(0.004));
  EXPECT_TRUE(events(0.002));
  EXPECT_FALSE(events(0.001));
  EXPECT_FALSE(events(0.005));
  EXPECT_FALSE(events(0.002)) << "it was not twice as far";
}

TEST(Detent, AStagesPeakComesWithinAFewTimeConstantsAndNoneLocksNothing) {
  Detent detent = gears();
  const std::vector<double> peaks = {4.0, 1.0}, none = {4.0, 0.0};
  const auto feel_by = [&](const std::vector<double>* by) {
    EffectInput in = test::at({1e-3, 0.03}, kFreeSpace);
    in.detent_peaks = by;
    EffectTick tick;
    tick.force = detent.force(in, tick);
    return tick;
  };
  EXPECT_NEAR(feel_by(nullptr).force.x(), -2.0, 1e-9);
  // 1 / 20 of what is missing each millisecond.
  EXPECT_NEAR(feel_by(&peaks).force.x(), -2.0 + 1.5 / 20.0, 1e-9);
  for (int i = 0; i < 1000; ++i) (void)feel_by(&peaks);
  EXPECT_NEAR(feel_by(&peaks).force.x(), -0.5, 1e-9);
  EXPECT_NEAR(detent.stiffness(), 4.0 / 2e-3, 1e-6) << "of the steepest";
  EXPECT_EQ(detent.locked(), 1);
  EXPECT_EQ(feel_by(&none).event_count, 1);
  EXPECT_EQ(detent.locked(), -1);
  for (int i = 0; i < 1000; ++i) (void)feel_by(nullptr);
  EXPECT_EQ(feel_by(nullptr).force.x(), feel(detent, {1e-3, 0.03}).force.x());
  EXPECT_NEAR(feel(detent, {1e-3, 0.03}).force.x(), -2.0, 1e-9);
}

}  // namespace
}  // namespace handrail
