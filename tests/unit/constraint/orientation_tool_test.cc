#include "server/constraint/orientation_tool.h"

#include <gtest/gtest.h>

#include <numbers>

#include "server/base/units.h"
#include "tests/unit/constraint/tool_samples.h"

namespace handrail {
namespace {

using test::Dice;

constexpr double kPi = std::numbers::pi;

OrientationTool keeping_axis(const Vec3& axis_T, const Vec3& axis_S) {
  ToolDefinition tool;
  tool.kind = ToolKind::kFRotation;
  tool.axis_T = axis_T.normalized();
  tool.normal_S = axis_S.normalized();
  return OrientationTool(tool);
}

OrientationTool keeping(const Quat& q) {
  ToolDefinition tool;
  tool.kind = ToolKind::kNRotation;
  tool.q_ref = q;
  return OrientationTool(tool);
}

// Angle between two unit vectors that stays exact near zero.
double off_axis(const Quat& q, const Vec3& axis_T, const Vec3& axis_S) {
  const Vec3 r = q * axis_T;
  return std::atan2(r.cross(axis_S).norm(), r.dot(axis_S));
}

TEST(OrientationTool, WithoutAToolTheProxyIsTheHand) {
  OrientationTool tool;
  const Quat hand = rotation_exp({0.1, 0.2, 0.3});
  EXPECT_EQ(tool.start(hand).coeffs(), hand.coeffs());
  EXPECT_EQ(tool.advance(hand).coeffs(), hand.coeffs());
  EXPECT_EQ(tool.deviation(hand), 0.0);
}

TEST(NRotation, KeepsItsOrientationForEveryHand) {
  Dice dice(21);
  const Quat q = dice.turn(kPi);
  OrientationTool tool = keeping(q);
  EXPECT_EQ(tool.start(dice.turn(kPi)).coeffs(), q.coeffs());
  for (int i = 0; i < 1000; ++i) {
    const Quat hand = dice.turn(kPi);
    EXPECT_EQ(tool.advance(hand).coeffs(), q.coeffs());
    EXPECT_NEAR(tool.deviation(hand), angle_between(q, hand), 1e-12);
  }
}

TEST(FRotation, KeepsItsAxisExactlyForRandomHands) {
  Dice dice(22);
  for (int run = 0; run < 50; ++run) {
    const Vec3 axis_T = dice.unit(), axis_S = dice.unit();
    OrientationTool tool = keeping_axis(axis_T, axis_S);
    const Quat aligned = smallest_turn(axis_T, axis_S);
    tool.start(aligned);
    for (int i = 0; i < 200; ++i) {
      const Quat hand = dice.turn(170 * kDeg) * aligned;
      const Quat proxy = tool.advance(hand);
      EXPECT_LT(off_axis(proxy, axis_T, axis_S), 1e-9);
      EXPECT_TRUE(is_unit(proxy, 1e-14));
    }
  }
}

TEST(FRotation, TurnsTheHandBackByTheSmallestRotation) {
  Dice dice(23);
  OrientationTool tool = keeping_axis(Vec3::UnitZ(), Vec3::UnitZ());
  tool.start(Quat::Identity());
  for (int i = 0; i < 500; ++i) {
    const Quat hand = dice.turn(170 * kDeg);
    const double phi = off_axis(hand, Vec3::UnitZ(), Vec3::UnitZ());
    EXPECT_NEAR(tool.deviation(hand), phi, 1e-12);
    // No rotation that returns the axis is smaller than the angle the axis is off by.
    EXPECT_NEAR(angle_between(hand, tool.advance(hand)), phi, 1e-9);
  }
}

TEST(FRotation, PassesTurningAboutItsAxisOneToOne) {
  OrientationTool tool = keeping_axis(Vec3::UnitZ(), Vec3::UnitX());
  const Quat aligned = smallest_turn(Vec3::UnitZ(), Vec3::UnitX());
  tool.start(aligned);
  for (double angle = -3.0; angle < 3.0; angle += 0.01) {
    const Quat hand = rotation_exp(angle * Vec3::UnitX()) * aligned;
    EXPECT_LT(angle_between(tool.advance(hand), hand), 1e-12);
  }
}

TEST(FRotation, IsSmoothAndFiniteWhereTheAxisIsNearlyOrExactlyRight) {
  OrientationTool tool = keeping_axis(Vec3::UnitZ(), Vec3::UnitZ());
  tool.start(Quat::Identity());
  for (const double phi : {0.0, 1e-300, 1e-160, 1e-17, 1e-13, 1e-12, 1e-9, 1e-6, 1e-3}) {
    const Quat hand = rotation_exp({phi, 0, 0}) * rotation_exp({0, 0, 0.7});
    const Quat proxy = tool.advance(hand);
    ASSERT_TRUE(is_finite(proxy));
    EXPECT_LT(angle_between(proxy, rotation_exp({0, 0, 0.7})), 1e-9) << phi;
    EXPECT_NEAR(tool.deviation(hand), phi, 1e-12);
  }
}

TEST(FRotation, HoldsTheProxyNearHalfATurnWithoutNaNOrFlip) {
  OrientationTool tool = keeping_axis(Vec3::UnitZ(), Vec3::UnitZ());
  Quat last = tool.start(Quat::Identity());
  // The tip's axis tumbles right over the pole, through exactly half a turn: the way back changes
  // sides there, and an unguarded proxy would turn by half a turn at once.
  for (double tilt = 0.0; tilt < 176.0; tilt += 0.25) {
    last = tool.advance(rotation_exp({tilt * kDeg, 0, 0}));
  }
  for (double tilt = 176.0; tilt <= 184.0; tilt += 0.25) {
    const Quat proxy = tool.advance(rotation_exp({tilt * kDeg, 0, 0}));
    ASSERT_TRUE(is_finite(proxy));
    EXPECT_LT(angle_between(proxy, last), 1e-9) << tilt;
    EXPECT_FALSE(tool.rejoined());
  }
  const Quat exactly_over(0.0, 1.0, 0.0, 0.0);
  EXPECT_TRUE(is_finite(tool.advance(exactly_over)));
  EXPECT_NEAR(tool.deviation(exactly_over), kPi, 1e-12);
}

TEST(FRotation, SaysWhenItRejoinsAfterHalfATurnAndOnlyOnce) {
  OrientationTool tool = keeping_axis(Vec3::UnitZ(), Vec3::UnitZ());
  tool.start(Quat::Identity());
  tool.advance(rotation_exp({179.0 * kDeg, 0, 0}));
  EXPECT_FALSE(tool.rejoined());
  const Quat back = tool.advance(rotation_exp({170.0 * kDeg, 0, 0}));
  EXPECT_TRUE(tool.rejoined());
  EXPECT_LT(off_axis(back, Vec3::UnitZ(), Vec3::UnitZ()), 1e-9);
  tool.advance(rotation_exp({169.0 * kDeg, 0, 0}));
  EXPECT_FALSE(tool.rejoined());
}

TEST(FRotation, TheHandsSignOfQuaternionDoesNotMatter) {
  Dice dice(24);
  for (int i = 0; i < 100; ++i) {
    OrientationTool a = keeping_axis(Vec3::UnitY(), Vec3::UnitX());
    OrientationTool b = a;
    a.start(smallest_turn(Vec3::UnitY(), Vec3::UnitX()));
    b.start(smallest_turn(Vec3::UnitY(), Vec3::UnitX()));
    const Quat hand = dice.turn(1.5), minus(-hand.w(), -hand.x(), -hand.y(), -hand.z());
    EXPECT_LT(angle_between(a.advance(hand), b.advance(minus)), 1e-12);
  }
}

}  // namespace
}  // namespace handrail
