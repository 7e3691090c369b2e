#include "devices/hand/hand_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "server/base/units.h"

namespace handrail {
namespace {

constexpr double kMotionTick = 1e-3;

HandIntent moved_by(const Vec3& displacement, double duration) {
  HandIntent intent;
  intent.displacement_M = displacement;
  intent.duration = duration;
  return intent;
}

void run(HandMotion& motion, double seconds) {
  const int ticks = static_cast<int>(seconds / kMotionTick + 0.5);
  for (int i = 0; i < ticks; ++i) motion.step(kMotionTick);
}

TEST(HandMotion, PeaksAtMinimumJerkSpeedHalfWay) {
  HandMotion motion(0.0);
  motion.steer(moved_by({0.0, 0.08, 0.0}, 0.5));
  double peak = 0.0;
  double at_half = 0.0;
  for (int i = 1; i <= 500; ++i) {
    motion.step(kMotionTick);
    peak = std::max(peak, motion.position().v.norm());
    if (i == 250) at_half = motion.position().v.norm();
  }
  EXPECT_NEAR(peak, 1.875 * 0.08 / 0.5, 1e-9);
  EXPECT_NEAR(at_half, peak, 1e-9);
  EXPECT_NEAR((motion.position().p - Vec3(0.0, 0.08, 0.0)).norm(), 0.0, 1e-15);
}

TEST(HandMotion, WaitsForTheReactionDelayThenArrivesOnTime) {
  HandMotion motion(0.2);
  motion.steer(moved_by({0.03, 0.0, 0.0}, 0.5));
  EXPECT_TRUE(motion.moving());
  run(motion, 0.2);
  EXPECT_NEAR(motion.position().p.norm(), 0.0, 1e-12);
  run(motion, 0.25);
  EXPECT_NEAR(motion.position().p.x(), 0.015, 1e-9);
  run(motion, 0.249);
  EXPECT_TRUE(motion.moving());
  run(motion, 0.002);
  EXPECT_FALSE(motion.moving());
  EXPECT_DOUBLE_EQ(motion.position().p.x(), 0.03);
}

TEST(HandMotion, DelayAndMoveDoNotDependOnTheStep) {
  HandMotion fine(0.1005);
  HandMotion coarse(0.1005);
  fine.steer(moved_by({0.03, 0.01, 0.0}, 0.4));
  coarse.steer(moved_by({0.03, 0.01, 0.0}, 0.4));
  for (int i = 0; i < 3000; ++i) fine.step(1e-4);
  for (int i = 0; i < 100; ++i) coarse.step(3e-3);
  EXPECT_LT((fine.position().p - coarse.position().p).norm(), 1e-12);
  EXPECT_GT(fine.position().p.norm(), 1e-3);
}

TEST(HandMotion, NewMoveTakesOverWithoutAJumpInSpeedOrAcceleration) {
  HandMotion motion(0.1);
  HandIntent turn = moved_by({0.05, 0.0, 0.0}, 0.5);
  turn.rotation_M = Vec3(0.0, 0.6, 0.0);
  motion.steer(turn);
  VectorMotion last = motion.position();
  Quat last_q = motion.orientation();
  Vec3 last_turn = Vec3::Zero();
  Vec3 last_bend = Vec3::Zero();
  for (int i = 0; i < 1500; ++i) {
    if (i == 300 || i == 700) {
      HandIntent other = moved_by({0.0, 0.04, -0.01}, 0.6);
      other.rotation_M = i == 300 ? Vec3(0.5, 0.0, 0.2) : Vec3(0.0, -0.4, 0.8);
      motion.steer(other);
    }
    motion.step(kMotionTick);
    const VectorMotion& now = motion.position();
    EXPECT_LT((now.p - last.p).norm(), 0.4 * kMotionTick) << i;
    EXPECT_LT((now.v - last.v).norm(), 3.0 * kMotionTick) << i;
    EXPECT_LT((now.a - last.a).norm(), 60.0 * kMotionTick + 1e-9) << i;
    const Vec3 turned = rotation_log(motion.orientation() * last_q.conjugate());
    EXPECT_LT((turned - last_turn).norm(), 25.0 * kMotionTick * kMotionTick) << i;
    const Vec3 bend = (turned - last_turn) / (kMotionTick * kMotionTick);
    EXPECT_LT((bend - last_bend).norm(), 2.0) << i;
    last = now;
    last_bend = bend;
    last_q = motion.orientation();
    last_turn = turned;
  }
}

TEST(HandMotion, GoalCountsFromWhereTheIntentStoodAtTheOrder) {
  HandMotion motion(0.2);
  motion.steer(moved_by({0.04, 0.0, 0.0}, 0.4));
  run(motion, 0.4);
  const Vec3 at_order = motion.position().p;
  EXPECT_NEAR(at_order.x(), 0.02, 1e-9);
  motion.steer(moved_by({0.0, 0.01, 0.0}, 0.3));
  run(motion, 1.0);
  EXPECT_LT((motion.position().p - at_order - Vec3(0.0, 0.01, 0.0)).norm(), 1e-12);
}

TEST(HandMotion, OrdersFasterThanTheReactionStillMoveTheHand) {
  HandMotion motion(0.2);
  for (int i = 0; i < 10; ++i) {
    motion.steer(moved_by({0.02, 0.0, 0.0}, 0.3));
    run(motion, 0.1);
  }
  EXPECT_GT(motion.position().p.x(), 0.02);
}

TEST(HandMotion, TurnsByTheRotationVectorInFrameM) {
  HandMotion motion(0.0);
  HandIntent intent;
  intent.rotation_M = Vec3(0.0, 0.0, 90.0 * kDeg);
  motion.steer(intent);
  run(motion, 1.0);
  intent.rotation_M = Vec3(90.0 * kDeg, 0.0, 0.0);
  motion.steer(intent);
  run(motion, 1.0);
  const Quat expected =
      rotation_exp(Vec3(90.0 * kDeg, 0.0, 0.0)) * rotation_exp(Vec3(0.0, 0.0, 90.0 * kDeg));
  EXPECT_LT(angle_between(motion.orientation(), expected), 1e-9);
}

TEST(HandMotion, HoldsButtonsOnlyDuringTheMove) {
  HandMotion motion(0.1);
  HandIntent intent = moved_by({0.01, 0.0, 0.0}, 0.2);
  intent.buttons = 3;
  motion.steer(intent);
  run(motion, 0.05);
  EXPECT_EQ(motion.buttons(), 0u);
  run(motion, 0.1);
  EXPECT_EQ(motion.buttons(), 3u);
  run(motion, 0.2);
  EXPECT_EQ(motion.buttons(), 0u);
}

TEST(HandMotion, IgnoresOrdersThatMakeNoSense) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  HandMotion motion(0.0);
  HandIntent twisted = moved_by({0.01, 0.0, 0.0}, 0.5);
  twisted.rotation_M.x() = kNan;
  for (const HandIntent& bad : {moved_by({kNan, 0.0, 0.0}, 1.0), moved_by({kInf, 0.0, 0.0}, 1.0),
                                moved_by({1e300, 0.0, 0.0}, 1.0), moved_by({0.01, 0.0, 0.0}, 0.0),
                                moved_by({0.01, 0.0, 0.0}, -1.0), moved_by({0.01, 0.0, 0.0}, kNan),
                                moved_by({0.01, 0.0, 0.0}, kInf), twisted}) {
    motion.steer(bad);
    EXPECT_FALSE(motion.moving());
  }
  run(motion, 0.1);
  EXPECT_EQ(motion.position().p, Vec3::Zero());
}

}  // namespace
}  // namespace handrail
