#include "server/haptic/mapping.h"

#include <gtest/gtest.h>

#include "tests/unit/constraint/tool_samples.h"

namespace handrail {
namespace {

using test::Dice;

Pose any_pose(Dice& dice) { return {dice.within(0.5), dice.turn(3.1)}; }

TEST(Mapping, DeviceRightUpAndTowardTheUserAreBaseMinusYPlusZMinusX) {
  const Engagement engagement{MappingSettings{}, Pose{}, Pose{}};
  EXPECT_LT((engagement.to_slave({{0.01, 0, 0}, {}}).p - Vec3(0, -0.02, 0)).norm(), 1e-15);
  EXPECT_LT((engagement.to_slave({{0, 0.01, 0}, {}}).p - Vec3(0, 0, 0.02)).norm(), 1e-15);
  EXPECT_LT((engagement.to_slave({{0, 0, 0.01}, {}}).p - Vec3(-0.02, 0, 0)).norm(), 1e-15);
}

TEST(Mapping, AStillHandIsExactlyTheLatchedTip) {
  Dice dice(41);
  for (int i = 0; i < 1000; ++i) {
    const Pose hand = any_pose(dice), tip = any_pose(dice);
    const Pose command = Engagement(MappingSettings(), hand, tip).to_slave(hand);
    EXPECT_EQ(command.p, tip.p);
    EXPECT_LT((command.q.coeffs() - tip.q.coeffs()).norm(), 1e-15);
  }
}

// The form without poses latched at engagement asks for a turn at once when the frames differ.
TEST(Mapping, FramesThatStartOutOfAlignmentDoNotTurnTheTip) {
  Dice dice(42);
  MappingSettings mapping;
  for (int i = 0; i < 200; ++i) {
    const Pose hand = any_pose(dice), tip = any_pose(dice);
    const Engagement engagement(mapping, hand, tip);
    // A turn of the hand about an axis of M is the same turn of the tip about that axis seen in S,
    // whatever the two orientations were.
    const Vec3 turn_M = dice.within(1.0);
    const Pose moved{hand.p, rotation_exp(turn_M) * hand.q};
    const Quat expected = rotation_exp(mapping.R_SM * turn_M) * tip.q;
    EXPECT_LT(angle_between(engagement.to_slave(moved).q, expected), 1e-12);
    EXPECT_EQ(engagement.to_slave(moved).p, tip.p);
  }
}

TEST(Mapping, ScalesTranslationNotRotation) {
  Dice dice(43);
  MappingSettings mapping;
  for (const double k : {0.1, 1.0, 2.0, 5.0}) {
    mapping.scale = k;
    const Pose hand = any_pose(dice), tip = any_pose(dice);
    const Vec3 move = dice.within(0.1), turn = dice.within(0.5);
    const Pose out =
        Engagement(mapping, hand, tip).to_slave({hand.p + move, rotation_exp(turn) * hand.q});
    EXPECT_NEAR((out.p - tip.p).norm(), k * move.norm(), 1e-14);
    EXPECT_NEAR(angle_between(out.q, tip.q), turn.norm(), 1e-12);
  }
}

TEST(Mapping, MappingADisplacementThereAndBackChangesNothing) {
  Dice dice(44);
  for (int i = 0; i < 100; ++i) {
    const Pose hand = any_pose(dice);
    const Engagement engagement(MappingSettings(), hand, any_pose(dice));
    const Vec3 move = dice.within(0.1);
    const Vec3 d_S = engagement.to_slave({hand.p + move, hand.q}).p - engagement.to_slave(hand).p;
    EXPECT_LT((engagement.to_hand(d_S) - move).norm(), 1e-14);
  }
}

// Stiffness is that felt at the hand: the work of the force over a small motion of the hand is the
// energy the spring loses, so that the mapping neither makes nor swallows energy.
TEST(Mapping, TheForceOnTheHandDoesTheSpringsVirtualWork) {
  Dice dice(45);
  constexpr double kStiffness = 800.0;
  for (int i = 0; i < 100; ++i) {
    MappingSettings mapping;
    mapping.scale = dice.between(0.5, 4.0);
    mapping.R_SM = dice.turn(3.0).toRotationMatrix();
    const Pose hand = any_pose(dice);
    const Engagement engagement(mapping, hand, any_pose(dice));
    const Vec3 proxy_S = engagement.to_slave(hand).p + dice.within(0.05);
    const auto energy = [&](const Vec3& p_MH) {
      const Vec3 d_S = proxy_S - engagement.to_slave({p_MH, hand.q}).p;
      return 0.5 * kStiffness * d_S.squaredNorm() / (mapping.scale * mapping.scale);
    };
    const Vec3 force = kStiffness * engagement.to_hand(proxy_S - engagement.to_slave(hand).p);
    const Vec3 move = 1e-6 * dice.unit();
    EXPECT_NEAR(force.dot(move), energy(hand.p - 0.5 * move) - energy(hand.p + 0.5 * move), 1e-12);
  }
}

TEST(Mapping, ATorqueKeepsItsSizeAndTurnsTheSameWay) {
  Dice dice(46);
  MappingSettings mapping;
  const Engagement engagement(mapping, any_pose(dice), any_pose(dice));
  const Vec3 twist_S = dice.within(1.0);
  EXPECT_LT((mapping.R_SM * engagement.turn_to_hand(twist_S) - twist_S).norm(), 1e-14);
}

}  // namespace
}  // namespace handrail
