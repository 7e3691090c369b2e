#include "devices/hand/hand_model.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace handrail {
namespace {

constexpr double kHandTick = 1e-3;

HandOptions still_hand() {
  HandOptions options;
  options.tremor_rms = 0.0;
  options.drift_rms = 0.0;
  options.drift_rotation_rms = 0.0;
  options.reaction = 0.0;
  return options;
}

HeldBody stylus() {
  HeldBody body;
  body.mass = 0.045;
  body.friction = 0.26;
  body.stop_half = Vec3(0.09, 0.07, 0.045);
  body.stop_stiffness = 10e3;
  body.stop_damping = 20.0;
  return body;
}

HandIntent move(const Vec3& displacement, double duration) {
  HandIntent intent;
  intent.displacement_M = displacement;
  intent.duration = duration;
  return intent;
}

Wrench force(const Vec3& f) { return {f, Vec3::Zero()}; }

TEST(HandModel, FollowsTheIntentExactlyWhenNothingPushes) {
  HandModel hand(still_hand(), stylus());
  hand.steer(move({0.05, 0.02, 0.0}, 0.5));
  double peak = 0.0;
  for (int i = 0; i < 600; ++i) {
    hand.step(kHandTick, Wrench{});
    peak = std::max(peak, hand.velocity().norm());
    // Only the fade-in of the expected friction, below 1 mm/s, may leave a trace.
    EXPECT_LT((hand.pose().p - hand.motion().position().p).norm(), 5e-5) << i;
  }
  EXPECT_NEAR(peak, 1.875 * Vec3(0.05, 0.02, 0.0).norm() / 0.5, 2e-3);
}

TEST(HandModel, YieldsToAForceByItsStiffnessAndWithItsDamping) {
  HandOptions options = still_hand();
  options.damping_ratio = 0.5;
  HandModel hand(options);
  double peak = 0.0;
  for (int i = 0; i < 3000; ++i) {
    hand.step(kHandTick, force({1.0, 0.0, 0.0}));
    peak = std::max(peak, hand.pose().p.x());
  }
  EXPECT_NEAR(hand.pose().p.x(), 1.0 / 250.0, 1e-7);
  // The overshoot of a second-order system: exp(-pi z / sqrt(1 - z^2)) = 0.163 at z = 0.5.
  EXPECT_NEAR(peak * 250.0 - 1.0, 0.163, 0.006);
}

TEST(HandModel, FrictionHoldsTheBodyExactlyUntilPushedHarder) {
  HandModel hand(still_hand(), stylus());
  for (int i = 0; i < 2000; ++i) hand.step(kHandTick, force({0.15, -0.15, 0.1}));
  EXPECT_EQ(hand.pose().p, Vec3::Zero());
  for (int i = 0; i < 2000; ++i) hand.step(kHandTick, force({0.0, 0.0, 1.0}));
  const Vec3 pushed = hand.pose().p;
  EXPECT_GT(pushed.z(), (1.0 - 0.26) / 250.0 - 1e-6);
  EXPECT_LT(pushed.z(), (1.0 + 0.26) / 250.0 + 1e-6);
  // Released: friction keeps a remainder, and nothing creeps.
  for (int i = 0; i < 3000; ++i) hand.step(kHandTick, Wrench{});
  const Vec3 rest = hand.pose().p;
  EXPECT_LE(rest.norm(), 0.26 / 250.0 + 1e-6);
  for (int i = 0; i < 1000; ++i) hand.step(kHandTick, Wrench{});
  EXPECT_EQ(hand.pose().p, rest);
}

TEST(HandModel, AMoveTooSlowForItsFrictionSticksAndSlipsWithoutJumps) {
  HandModel hand(still_hand(), stylus());
  hand.steer(move({0.002, 0.0, 0.0}, 10.0));
  int stuck = 0;
  for (int i = 0; i < 10'000; ++i) {
    const Vec3 before = hand.pose().p;
    const Vec3 v_before = hand.velocity();
    hand.step(kHandTick, Wrench{});
    const Vec3 moved = hand.pose().p - before;
    stuck += moved.norm() == 0.0 ? 1 : 0;
    EXPECT_LE(moved.norm(),
              2.0 * kHandTick * std::max(v_before.norm(), hand.velocity().norm()) + 1e-6);
  }
  EXPECT_GT(stuck, 1000);
  EXPECT_NEAR(hand.pose().p.x(), 0.002, 0.26 / 250.0);
}

// The device as a wall on a delayed reading: bounded, and settling, for firm and for light grips.
TEST(HandModel, StaysBoundedAgainstAStiffVirtualSpring) {
  for (const double stiffness : {250.0, 50.0}) {
    for (const double friction : {0.26, 0.0}) {
      HandOptions options = still_hand();
      options.stiffness = stiffness;
      HeldBody body = stylus();
      body.friction = friction;
      HandModel hand(options, body);
      hand.steer(move({0.02, 0.0, 0.0}, 0.2));
      for (int i = 0; i < 250; ++i) hand.step(kHandTick, Wrench{});
      double peak = 0.0;
      double late_speed = 0.0;
      for (int i = 0; i < 5000; ++i) {
        hand.step(kHandTick, force(-800.0 * hand.pose().p));
        peak = std::max(peak, hand.pose().p.norm());
        if (i >= 4000) late_speed = std::max(late_speed, hand.velocity().norm());
      }
      EXPECT_LT(peak, 0.0201) << stiffness << " N/m, friction " << friction;
      EXPECT_LT(late_speed, 1e-4) << stiffness << " N/m, friction " << friction;
    }
  }
}

TEST(HandModel, RestsAgainstTheStopOfItsWorkSpace) {
  HandModel hand(still_hand(), stylus());
  hand.steer(move({0.3, 0.0, 0.0}, 0.3));
  double peak = 0.0;
  for (int i = 0; i < 3000; ++i) {
    hand.step(kHandTick, Wrench{});
    peak = std::max(peak, hand.pose().p.x());
    ASSERT_TRUE(is_finite(hand.pose()));
  }
  EXPECT_GT(hand.pose().p.x(), 0.09);
  EXPECT_LT(hand.pose().p.x(), 0.097);
  EXPECT_LT(peak, 0.110);
  EXPECT_EQ(hand.velocity(), Vec3::Zero());
}

TEST(HandModel, TorqueTurnsTheStylusAgainstTheWrist) {
  HandModel hand(still_hand());
  for (int i = 0; i < 3000; ++i) hand.step(kHandTick, {Vec3::Zero(), Vec3(0.0, 0.1, 0.0)});
  EXPECT_LT((rotation_log(hand.pose().q) - Vec3(0.0, 0.1, 0.0)).norm(), 1e-6);
  EXPECT_EQ(hand.pose().p, Vec3::Zero());
}

TEST(HandModel, SpeedOfTheTipHasNoJumps) {
  HandOptions options;
  options.seed = 11;
  HandModel hand(options, stylus());
  Vec3 last = hand.velocity();
  for (int i = 0; i < 10'000; ++i) {
    if (i % 700 == 0) hand.steer(move({i % 1400 == 0 ? 0.04 : -0.04, 0.01, 0.0}, 0.5));
    hand.step(kHandTick, Wrench{});
    // 20 m/s^2: above a human's 5.8 D / T^2 = 1 m/s^2, friction's 2 N/kg, and tremor's.
    EXPECT_LT((hand.velocity() - last).norm(), 20.0 * kHandTick) << i;
    last = hand.velocity();
  }
}

}  // namespace
}  // namespace handrail
