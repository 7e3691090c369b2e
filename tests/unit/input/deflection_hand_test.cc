#include "devices/input/deflection_hand.h"

#include <gtest/gtest.h>

#include <limits>

#include "server/base/units.h"

namespace handrail {
namespace {

DeflectionSettings settings_of(DeflectionMode mode) {
  DeflectionSettings s;
  s.mode = mode;
  s.speed = 0.04;
  s.turn_rate = 0.5;
  s.reach = 0.06;
  s.tilt = 0.4;
  return s;
}

void step_for(DeflectionHand& hand, const Deflection& d, double seconds, bool recentre = false) {
  for (double t = 0.0; t < seconds - 1e-9; t += 1e-3) hand.step(d, recentre, 1e-3);
}

TEST(DeflectionHand, VelocityIsTheShareOfTheSpeed) {
  DeflectionHand hand(settings_of(DeflectionMode::kVelocity));
  const Deflection half{Vec3(0.5, 0.0, -1.0), Vec3::Zero()};
  step_for(hand, half, 0.5);
  EXPECT_LT((hand.velocity() - Vec3(0.02, 0.0, -0.04)).norm(), 1e-6);
  const Vec3 before = hand.pose().p;
  step_for(hand, half, 0.25);
  EXPECT_LT((hand.pose().p - before - Vec3(0.005, 0.0, -0.01)).norm(), 1e-6);
}

TEST(DeflectionHand, WithoutAPushTheHandRestsWhereItIs) {
  DeflectionHand hand(settings_of(DeflectionMode::kVelocity));
  step_for(hand, {Vec3(1.0, 0.0, 0.0), Vec3(0.0, 1.0, 0.0)}, 0.5);
  step_for(hand, Deflection(), 0.5);
  const Pose before = hand.pose();
  EXPECT_NEAR(before.p.x(), 0.02, 1e-4);
  EXPECT_NEAR(rotation_log(before.q).y(), 0.25, 1e-3);
  step_for(hand, Deflection(), 1.0);
  EXPECT_LT((hand.pose().p - before.p).norm(), 1e-9);
  EXPECT_LT(hand.velocity().norm(), 1e-9);
}

TEST(DeflectionHand, TheWorkSpaceEndsThePlaceAndTheVelocity) {
  DeflectionHand hand(settings_of(DeflectionMode::kVelocity));
  step_for(hand, {Vec3(0.0, 1.0, 0.0), Vec3::Zero()}, 5.0);
  EXPECT_EQ(hand.pose().p.y(), 0.06);
  EXPECT_EQ(hand.velocity().y(), 0.0);
}

TEST(DeflectionHand, AFreeHandGoesBackToTheMiddleWhateverIsPushed) {
  DeflectionHand hand(settings_of(DeflectionMode::kVelocity));
  const Deflection pushed{Vec3(1.0, 1.0, 0.0), Vec3::Zero()};
  step_for(hand, pushed, 3.0);
  ASSERT_GT(hand.pose().p.norm(), 0.08);
  step_for(hand, pushed, 2.0, true);
  EXPECT_LT(hand.pose().p.norm(), 1e-4);
}

TEST(DeflectionHand, PositionIsTheShareOfTheReach) {
  DeflectionHand hand(settings_of(DeflectionMode::kPosition));
  step_for(hand, {Vec3(0.5, 0.0, -0.25), Vec3(0.0, 0.0, 0.5)}, 0.5);
  EXPECT_LT((hand.pose().p - Vec3(0.03, 0.0, -0.015)).norm(), 1e-6);
  EXPECT_LT((rotation_log(hand.pose().q) - Vec3(0.0, 0.0, 0.2)).norm(), 1e-6);
  step_for(hand, Deflection(), 0.5);
  EXPECT_LT(hand.pose().p.norm(), 1e-6);
}

// A loop's limits see the velocity: it is that of the place, and has no leaps.
TEST(DeflectionHand, ALeapOfTheDeflectionIsAVelocityWithoutLeaps) {
  for (const DeflectionMode mode : {DeflectionMode::kVelocity, DeflectionMode::kPosition}) {
    DeflectionHand hand(settings_of(mode));
    Vec3 place = hand.pose().p, velocity = Vec3::Zero();
    for (int i = 0; i < 400; ++i) {
      const double x = i / 100 % 2 == 0 ? 1.0 : -1.0;
      hand.step({Vec3(x, 0.0, 0.0), Vec3::Zero()}, false, 1e-3);
      EXPECT_LT((hand.pose().p - place - 1e-3 * hand.velocity()).norm(), 1e-12);
      // Of position: 2 x reach / smoothing^2, the first answer of two lags in series.
      EXPECT_LT((hand.velocity() - velocity).norm(), 0.5 + 1e-6) << i;
      place = hand.pose().p;
      velocity = hand.velocity();
    }
  }
}

// So it needs no guard of its own: two lags in series go at most reach / (e x smoothing).
TEST(DeflectionHand, ALeapOfTheDeflectionIsSlowerThanAFastHand) {
  DeflectionSettings settings = settings_of(DeflectionMode::kPosition);
  settings.reach = 0.1;
  DeflectionHand hand(settings);
  double most = 0.0;
  for (int i = 0; i < 200; ++i) {
    hand.step({Vec3(1.0, 0.0, 0.0), Vec3::Zero()}, false, 1e-3);
    most = std::max(most, hand.velocity().norm());
  }
  EXPECT_NEAR(most, 2.3, 0.1) << "and a leap is what is faster than 10 m/s";
}

TEST(DeflectionHand, WhoIsGoneMovesNothingMore) {
  for (const DeflectionMode mode : {DeflectionMode::kVelocity, DeflectionMode::kPosition}) {
    DeflectionHand hand(settings_of(mode));
    step_for(hand, {Vec3(1.0, 0.0, 0.0), Vec3(1.0, 0.0, 0.0)}, 0.3);
    const Pose before = hand.pose();
    hand.halt();
    EXPECT_EQ(hand.velocity().norm(), 0.0);
    EXPECT_EQ(hand.pose().p, before.p);
    hand.step(Deflection(), false, 1e-3);
    EXPECT_LT((hand.pose().p - before.p).norm(), 4e-4) << "goes on from where it was";
    EXPECT_LT(before.q.angularDistance(hand.pose().q), 4e-3);
  }
}

TEST(DeflectionHand, SenselessSharesAreBoundedOrNone) {
  constexpr double kHuge = 1e300, kNan = std::numeric_limits<double>::quiet_NaN();
  DeflectionHand hand(settings_of(DeflectionMode::kVelocity));
  step_for(hand, {Vec3(kHuge, 0.0, 0.0), Vec3(0.0, kNan, 0.0)}, 1.0);
  EXPECT_NEAR(hand.velocity().x(), 0.04, 1e-9);
  EXPECT_TRUE(is_unit(hand.pose().q));
  EXPECT_EQ(rotation_log(hand.pose().q).norm(), 0.0);
}

TEST(DeflectionHand, ItsCapabilitiesSayThatItMakesNoForce) {
  DeflectionSettings s = settings_of(DeflectionMode::kVelocity);
  EXPECT_TRUE(deflection_capabilities(s).senses_rotation);
  EXPECT_EQ(deflection_capabilities(s).max_force, 0.0);
  EXPECT_EQ(deflection_capabilities(s).continuous_force, 0.0);
  EXPECT_FALSE(deflection_capabilities(s).simulated);
  EXPECT_EQ(deflection_capabilities(s).workspace_half, Vec3::Constant(0.06));
  s.turn_rate = 0.0;
  EXPECT_FALSE(deflection_capabilities(s).senses_rotation);
}

}  // namespace
}  // namespace handrail
