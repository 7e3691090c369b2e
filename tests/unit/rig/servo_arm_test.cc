#include "devices/rig/servo_arm.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "server/base/units.h"
#include "tests/support/no_allocation.h"

namespace handrail {
namespace {

ServoArmOptions quiet_arm() {
  ServoArmOptions options;
  options.repeatability = 0.0;
  return options;
}

JointVector moved(double by) {
  return ServoArmOptions::default_start() + JointVector::Constant(by);
}

TEST(ServoArm, StandsStillWithoutACommand) {
  ServoArm arm(quiet_arm());
  arm.advance(10.0);
  EXPECT_EQ(arm.joints(), ServoArmOptions::default_start());
  EXPECT_EQ(arm.measured(), arm.joints());
}

TEST(ServoArm, FollowsAStepAsTheFirstOrderLagSays) {
  ServoArm arm(quiet_arm());
  arm.command(moved(0.1));
  arm.advance(0.02);
  for (int i = 0; i < kJoints; ++i) {
    const double covered = arm.joints()[i] - ServoArmOptions::default_start()[i];
    EXPECT_NEAR(covered, 0.1 * (1.0 - std::exp(-0.02 / arm.lag()[i])), 1e-12);
  }
}

TEST(ServoArm, TrailsARampByItsLag) {
  ServoArm arm(quiet_arm());
  constexpr double kSpeed = 0.5;  // [rad/s]
  constexpr double kDt = 1e-3;
  double q = 0.0;
  for (int i = 0; i < 2000; ++i) {
    q += kSpeed * kDt;
    arm.command(moved(q));
    arm.advance(kDt);
  }
  for (int i = 0; i < kJoints; ++i) {
    // The target is held for each step, so the lag seen is between tau - dt and tau.
    const double trail = (moved(q)[i] - arm.joints()[i]) / kSpeed;
    EXPECT_NEAR(trail, arm.lag()[i], kDt);
  }
}

TEST(ServoArm, AnySplitOfTheTimeGivesTheSameJoints) {
  ServoArmOptions options;
  ServoArm whole(options);
  ServoArm split(options);
  whole.advance(1.0);
  split.advance(1.0);
  whole.command(moved(0.3));
  split.command(moved(0.3));
  whole.advance(0.05);
  for (const double dt : {0.0, 0.001, 0.0201, 0.02, 0.0089}) split.advance(dt);
  EXPECT_LT((whole.joints() - split.joints()).norm(), 1e-14);
  EXPECT_LT((whole.measured() - split.measured()).norm(), 1e-14);
}

TEST(ServoArm, DrawsLagsWithinTheSpreadAndKeepsThoseSet) {
  double low = 1.0;
  double high = 0.0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    ServoArmOptions options;
    options.seed = seed;
    options.joint_lag[2] = 0.031;
    const ServoArm arm(options);
    EXPECT_EQ(arm.lag()[2], 0.031);
    for (const int i : {0, 1, 3, 4, 5}) {
      EXPECT_GE(arm.lag()[i], 0.045 * 0.97);
      EXPECT_LE(arm.lag()[i], 0.045 * 1.03);
    }
    EXPECT_NE(arm.lag()[0], arm.lag()[1]);
    low = std::min(low, arm.lag()[0]);
    high = std::max(high, arm.lag()[0]);
  }
  EXPECT_LT(low, 0.045 * 0.975);
  EXPECT_GT(high, 0.045 * 1.025);
}

TEST(ServoArm, SameSeedSameArm) {
  ServoArmOptions options;
  const ServoArm first(options);
  const ServoArm again(options);
  options.seed = 2;
  const ServoArm other(options);
  EXPECT_EQ(first.lag(), again.lag());
  EXPECT_EQ(first.measured(), again.measured());
  EXPECT_NE(first.lag(), other.lag());
  EXPECT_NE(first.measured(), other.measured());
}

double tip_error(const ServoArm& arm) {
  return (forward(arm.geometry(), arm.measured()).p - arm.true_tip().p).norm();
}

TEST(ServoArm, ReadsEveryStopWithTheConfiguredRepeatability) {
  ServoArm arm(ServoArmOptions{});
  double sum = 0.0;
  constexpr int kStops = 4000;
  for (int i = 0; i < kStops; ++i) {
    arm.command(moved(i % 2 == 0 ? 0.02 : 0.0));
    arm.advance(1.0);
    sum += std::pow(tip_error(arm), 2);
  }
  EXPECT_NEAR(std::sqrt(sum / kStops), 0.04 * kMm, 0.002 * kMm);
}

TEST(ServoArm, TheOffsetIsStillWhileTheArmIsAndWithoutJumpsWhenItMoves) {
  ServoArm arm(ServoArmOptions{});
  const JointVector offset = arm.measured() - arm.joints();
  EXPECT_GT(offset.norm(), 0.0);
  arm.advance(1.0);
  EXPECT_EQ(JointVector(arm.measured() - arm.joints()), offset);
  arm.command(moved(0.01));
  EXPECT_EQ(JointVector(arm.measured() - arm.joints()), offset);
  arm.advance(1e-3);
  const double first_step = (arm.measured() - arm.joints() - offset).norm();
  arm.advance(1.0);
  const double whole = (arm.measured() - arm.joints() - offset).norm();
  EXPECT_GT(whole, 0.0);
  EXPECT_LT(first_step, 0.04 * whole);
}

TEST(ServoArm, TheOffsetSettlesWhileTheArmKeepsMoving) {
  ServoArm arm(ServoArmOptions{});
  arm.advance(1.0);
  const auto move = [&arm](int from, int to) {
    for (int i = from; i < to; ++i) {
      arm.command(moved(1e-4 * i));
      arm.advance(7.11e-3);
    }
    return JointVector(arm.measured() - arm.joints());
  };
  const JointVector offset = move(1, 300);
  EXPECT_LT((move(300, 600) - offset).norm(), 1e-12) << "no noise on the way";
}

TEST(ServoArm, DoesNotAllocate) {
  ServoArm arm(ServoArmOptions{});
  test::NoAllocation guard("a servo cycle");
  arm.advance(1.0);
  arm.command(moved(0.01));
  arm.advance(0.007);
}

}  // namespace
}  // namespace handrail
