// What a first contact comes to when something went wrong before it.
#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/follow/follow_floor.h"

namespace handrail {
namespace {

using test::Floor;

constexpr double kPromise = 200.0;  // [N]

// An arm 42 ms behind its commands, 50 mm over a floor, that has been led to and fro.
struct Approach {
  Floor floor{60e3, 6};
  int i = 0;
  int missing = 1 << 30;  // every so many cycles nothing is measured

  Approach() {
    floor.rig.settings.bumper.promise = kPromise;
    floor.surface -= 0.05;
    roam(500);
  }
  void roam(int cycles) {
    for (const int end = i + cycles; i < end; ++i) {
      floor.X.p.y() = floor.rig.state.motion.X_ST.p.y() + (i / 100 % 2 == 0 ? 0.05 : -0.05);
      floor.silent = i % missing == 0;
      floor.cycle();
    }
  }
  // The largest force of a hasty contact [N].
  double touch() {
    double most = 0.0;
    floor.X = floor.rig.state.motion.X_ST;
    for (int k = 0; k < 1500; ++k) {
      floor.silent = k % missing == 0;
      floor.down(0.25, 0.05);
      most = std::max(most, floor.force);
    }
    EXPECT_EQ(floor.rig.out.link.state, SessionState::kEngaged);
    return most;
  }
  void reset() {
    FollowInput& in = floor.rig.in;
    in.master.fault_reset = floor.rig.out.link.fault_epoch;
    in.master.state = SessionState::kOff;
    in.master.desired = Desired::kOff;
    for (int k = 0; k < 100; ++k) floor.cycle();
    ASSERT_EQ(floor.rig.out.link.state, SessionState::kOff);
    floor.rig.engage();
    ASSERT_EQ(floor.rig.out.link.state, SessionState::kEngaged);
  }
};

TEST(FollowApproach, ThePromiseHoldsWithoutAnyFault) {
  Approach arm;
  const double most = arm.touch();
  EXPECT_LT(most, kPromise);
  EXPECT_GT(most, 80.0);
}

TEST(FollowApproach, ThePromiseHoldsAfterGlitchesOfAnEncoderThatAreBelieved) {
  for (const double glitch : {0.09, -0.09, 0.02}) {
    for (int joint = 0; joint < kJoints; ++joint) {
      Approach arm;
      for (int k = 0; k < 3; ++k) {
        arm.floor.off = glitch * JointVector::Unit(joint);
        arm.roam(1);
        arm.floor.off.setZero();
        arm.roam(5);
      }
      EXPECT_LT(arm.touch(), kPromise) << glitch << " at " << joint;
    }
  }
}

TEST(FollowApproach, ThePromiseHoldsWhereRepliesAreMissing) {
  for (const int each : {2, 5, 20}) {
    Approach arm;
    arm.missing = each;
    arm.roam(1000);
    const double most = arm.touch();
    EXPECT_GT(most, 40.0) << each;
    EXPECT_LT(most, kPromise) << each;
  }
}

TEST(FollowApproach, ThePromiseHoldsAfterAnEncoderWasWrongAndReset) {
  for (const double wrong : {0.5, -0.5, std::numeric_limits<double>::quiet_NaN()}) {
    Approach arm;
    arm.floor.off[1] = wrong;
    for (int k = 0; k < 20; ++k) arm.floor.cycle();
    arm.floor.off.setZero();
    // The way back is a jump as well: a reset meant for the first is none for that.
    for (int k = 0; k < 20; ++k) arm.floor.cycle();
    ASSERT_EQ(arm.floor.rig.out.link.state, SessionState::kFault) << wrong;
    arm.reset();
    EXPECT_DOUBLE_EQ(arm.floor.rig.state.lag.lag(), LagEstimate::kMost) << wrong;
    EXPECT_LT(arm.touch(), kPromise) << wrong;
  }
}

// Whoever it was, the arm may have become slow: nothing of before is believed.
TEST(FollowApproach, AnArmThatIsPlacedAnewIsApproachedWithAsIfItWereTheSlowest) {
  Approach arm;
  EXPECT_LT(arm.floor.rig.state.lag.lag(), 0.06);
  const JointVector q = arm.floor.rig.state.motion.joints.q;
  place(arm.floor.rig.settings, q, arm.floor.rig.state);
  EXPECT_DOUBLE_EQ(arm.floor.rig.state.lag.lag(), LagEstimate::kMost);
}

// A second of any motion shows the lag, so the time lost is short.
TEST(FollowApproach, TheArmIsAsFastAsItsLagAllowsAfterASecond) {
  Floor floor(60e3, 6);
  floor.rig.settings.bumper.promise = kPromise;
  floor.surface -= 0.1;
  const double dt = floor.rig.settings.motion->dt;
  for (int i = 0; i < 140; ++i) floor.down(0.25, 0.1);
  const double before = floor.height();
  for (int i = 0; i < 70; ++i) floor.down(0.25, 0.1);
  const double speed = (before - floor.height()) / (70.0 * dt);
  const BumperSettings& bumper = floor.rig.settings.bumper;
  const double allowed =
      approach_speed(bumper, kPromise - bumper.threshold, 6 * dt + bumper.sensor_lag, dt);
  EXPECT_GT(speed, 0.97 * allowed);
}

}  // namespace
}  // namespace handrail
