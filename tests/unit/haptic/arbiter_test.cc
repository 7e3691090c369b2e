#include "server/haptic/arbiter.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/constraint/tool_samples.h"

namespace handrail {
namespace {

constexpr double kTick = 1e-3;
const Vec3 kNone = Vec3::Zero();

TEST(Arbiter, TheDevicesOwnLimitComesLastEvenWhenItIsLoweredAtOnce) {
  Arbiter arbiter;
  ForceLimits limits;
  for (int i = 0; i < 200; ++i) arbiter.share(limits, {5, 0, 0}, kNone, 0.0, Trust::kBoth, kTick);
  limits.peak = 1.0;
  const ForceShares out = arbiter.share(limits, {5, 0, 0}, kNone, 0.0, Trust::kBoth, kTick);
  EXPECT_LE(out.device.norm(), 1.0 + 1e-12);
}

TEST(Arbiter, ADeviceThatMakesNoForceGetsNone) {
  Arbiter arbiter;
  ForceLimits limits;
  limits.peak = limits.continuous = 0.0;
  for (int i = 0; i < 200; ++i) {
    const ForceShares out = arbiter.share(limits, {5, 0, 0}, {0, 1, 0}, 1.0, Trust::kBoth, kTick);
    ASSERT_EQ(out.device, kNone) << i;
    ASSERT_EQ(out.spring, kNone) << i;
  }
}

TEST(Arbiter, AForceThatIsNoNumberOrCannotBeSquaredCountsAsNone) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity(), 1e300, -1e200}) {
    Arbiter arbiter;
    const ForceLimits limits;
    ForceShares out;
    for (int i = 0; i < 100; ++i) {
      out = arbiter.share(limits, {1, 0, 0}, {0, bad, 0}, 0.0, Trust::kBoth, kTick);
      ASSERT_TRUE(is_finite(out.device));
    }
    EXPECT_LT((out.device - Vec3(1, 0, 0)).norm(), 1e-12);
    EXPECT_EQ(out.spring, kNone);
    for (int i = 0; i < 100; ++i) {
      out = arbiter.share(limits, {bad, 0, 0}, {0, 1, 0}, 0.0, Trust::kBoth, kTick);
    }
    EXPECT_LT((out.device - Vec3(0, 1, 0)).norm(), 1e-12);
  }
}

TEST(Arbiter, TheSpringGetsWhatTheToolLeavesWhateverTheirAngle) {
  test::Dice dice(71);
  const ForceLimits limits;
  for (int i = 0; i < 300; ++i) {
    Arbiter arbiter;
    const Vec3 tool = dice.within(2.5), spring = dice.within(5.0);
    const ForceShares out = arbiter.share(limits, tool, spring, 1e3, Trust::kBoth, kTick);
    ASSERT_LE(out.device.norm(), limits.peak + 1e-12);
    if (tool.norm() > limits.peak) continue;
    // The tool's force is there in full; what is on top points along the spring.
    const Vec3 rest = out.device - tool;
    ASSERT_LT(rest.cross(spring).norm(), 1e-9);
    ASSERT_GE(rest.dot(spring), -1e-12);
    // And it is all the spring wants, or all there is room for.
    ASSERT_TRUE((rest - spring).norm() < 1e-9 || out.device.norm() > limits.peak - 1e-9);
    ASSERT_EQ(out.budget, (rest - spring).norm() > 1e-9);
  }
}

// Nothing is kept for a tool that is not there: the device's own limit is what takes.
TEST(Arbiter, WithoutAToolTheDevicesLimitIsNamedForWhatTheSpringIsLeft) {
  const ForceLimits limits;
  Arbiter cold, hot;
  const ForceShares out = cold.share(limits, kNone, {5, 0, 0}, 1e3, Trust::kBoth, kTick);
  EXPECT_NEAR(out.spring.norm(), limits.peak, 1e-12);
  EXPECT_TRUE(out.clamped);
  EXPECT_FALSE(out.budget);
  EXPECT_FALSE(out.thermal);
  ForceShares warm;
  for (int i = 0; i < 20'000; ++i) {
    warm = hot.share(limits, kNone, {5, 0, 0}, 1e3, Trust::kBoth, kTick);
  }
  EXPECT_LT(warm.spring.norm(), 0.9 * limits.peak);
  EXPECT_TRUE(warm.thermal);
  EXPECT_FALSE(warm.budget);
  EXPECT_FALSE(warm.clamped);
}

TEST(Arbiter, WithoutTrustAnyForceLeavesWithinTheFadeTime) {
  Arbiter arbiter;
  const ForceLimits limits;
  for (int i = 0; i < 200; ++i) arbiter.share(limits, {5, 0, 0}, kNone, 0.0, Trust::kBoth, kTick);
  ForceShares out;
  for (int i = 0; i < 50; ++i)
    out = arbiter.share(limits, {5, 0, 0}, kNone, 9.0, Trust::kNone, kTick);
  EXPECT_LT(out.device.norm(), 1e-12);
}

TEST(Arbiter, WithTrustInTheToolAloneTheSpringLeavesWithinTheFadeTime) {
  Arbiter arbiter;
  const ForceLimits limits;
  const auto share = [&](Trust trust) {
    return arbiter.share(limits, {1, 0, 0}, {0, 2, 0}, 0.0, trust, kTick);
  };
  for (int i = 0; i < 200; ++i) share(Trust::kBoth);
  ASSERT_LT((share(Trust::kBoth).device - Vec3(1, 2, 0)).norm(), 1e-12);
  ForceShares out;
  for (int i = 0; i < 25; ++i) out = share(Trust::kTool);
  EXPECT_LT((out.device - Vec3(1, 0, 0)).norm(), 1e-12);
  EXPECT_LT(out.spring.norm(), 1e-12);
}

}  // namespace
}  // namespace handrail
