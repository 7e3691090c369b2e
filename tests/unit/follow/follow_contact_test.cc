// Contact and its sensor in the slave's step.
#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/follow/follow_rig.h"

namespace handrail {
namespace {

using test::FollowRig;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// At home the tip points down: +Z of the tip frame is -Z of the base.
constexpr double kDownIsPlus = 1.0;

void press(FollowRig& rig, double newtons_up) {
  rig.in.f_E_T.force.z() = -kDownIsPlus * newtons_up;
}

TEST(FollowContact, TheSensorsForceIsTurnedIntoTheBaseFrame) {
  FollowRig rig;
  press(rig, 10.0);
  rig.cycle();
  EXPECT_LT((rig.out.link.f_E_S.force - Vec3(0, 0, 10)).norm(), 1e-9);
  EXPECT_TRUE(rig.out.link.has_wrench);
}

TEST(FollowContact, OverTheThresholdThePublishedPushStopsAndMovingAwayIsFree) {
  FollowRig rig;
  rig.settings.bumper.form = BumperSettings::Form::kPublished;
  rig.engage();
  const double height = rig.tip.p.z();
  Pose X = rig.state.motion.X_ST;
  press(rig, 100.0);
  X.p.z() -= 0.02;
  for (int i = 0; i < 50; ++i) rig.follow(X);
  EXPECT_NEAR(rig.tip.p.z(), height, 1e-9);
  EXPECT_EQ(rig.out.link.reason, Reason::kBumper);
  X.p.z() += 0.03;
  for (int i = 0; i < 100; ++i) {
    press(rig, 100.0 + 1e-6 * i);  // not the same bits: that would be a stuck sensor
    rig.follow(X);
  }
  // Free, and a hundredth of a millimetre a newton further.
  EXPECT_NEAR(rig.tip.p.z(), X.p.z() + 1e-3, 1e-9);
}

TEST(FollowContact, ASensorsNoiseIsNotAContact) {
  FollowRig rig;
  rig.engage();
  const JointVector held = rig.joints();
  for (int i = 0; i < 100; ++i) {
    press(rig, i % 2 == 0 ? 1.9 : -1.9);
    rig.cycle();
    ASSERT_EQ(rig.joints(), held);
  }
}

TEST(FollowContact, ANonFiniteOrOverrangeReadingNeverEntersAndTheThirdInARowIsAFault) {
  const Vec3 bad[] = {
      {kNaN, 0, 0}, {0, std::numeric_limits<double>::infinity(), 0}, {0, 0, 1500}, {0, 0, 1e308}};
  for (const Vec3& f : bad) {
    for (const bool required : {false, true}) {
      FollowRig rig;
      rig.settings.sensor_required = required;
      rig.engage();
      press(rig, 20.0);
      rig.cycle();
      const Wrench before = rig.out.link.f_E_S;
      rig.in.f_E_T.force = f;
      for (int i = 0; i < 2; ++i) {
        // The last reading stands; nothing stops.
        rig.cycle();
        EXPECT_LT((rig.out.link.f_E_S.force - before.force).norm(), 1e-6);
        EXPECT_FALSE(rig.out.link.has_wrench);
        EXPECT_EQ(rig.out.link.state, SessionState::kEngaged);
      }
      rig.cycle();
      EXPECT_EQ(rig.out.link.f_E_S.force, Vec3(Vec3::Zero()));
      for (int i = 0; i < 5; ++i) rig.cycle();
      EXPECT_EQ(rig.out.link.reason,
                f.allFinite() ? Reason::kSensorOverrange : Reason::kSensorInvalid);
      EXPECT_EQ(rig.out.link.state, required ? SessionState::kFault : SessionState::kEngaged);
      EXPECT_TRUE(rig.watch.kept());
      EXPECT_TRUE(is_finite(rig.out.link.f_E_S));
    }
  }
}

TEST(FollowContact, ANonFiniteTorqueNeverReachesTheMaster) {
  FollowRig rig;
  rig.in.f_E_T.torque.x() = kNaN;
  for (int i = 0; i < 5; ++i) {
    rig.cycle();
    EXPECT_TRUE(is_finite(rig.out.link.f_E_S));
  }
}

TEST(FollowContact, ASensorSilentForThreeCyclesIsMissingAndHoldsTheArmWhereItIsRequired) {
  for (const bool required : {false, true}) {
    FollowRig rig;
    rig.settings.sensor_required = required;
    rig.engage();
    rig.in.wrench_valid = false;
    rig.cycle();
    rig.cycle();
    EXPECT_EQ(rig.out.link.state, SessionState::kEngaged);
    rig.cycle();
    EXPECT_EQ(rig.out.link.reason, Reason::kSensorMissing);
    EXPECT_EQ(rig.out.link.state, required ? SessionState::kFault : SessionState::kEngaged);
    // One good reading in between starts the count afresh.
    FollowRig flaky;
    flaky.settings.sensor_required = true;
    flaky.engage();
    for (int i = 0; i < 30; ++i) {
      flaky.in.wrench_valid = i % 3 == 2;
      flaky.cycle();
    }
    EXPECT_EQ(flaky.out.link.state, SessionState::kEngaged);
  }
}

// A surface of stiffness `k` [N/m] under the tip, whose force the sensor sees with noise.
TEST(FollowContact, PushingIntoASurfaceSettlesNearTheThresholdWithoutChatter) {
  for (const double k : {5e3, 30e3, 60e3, -60e3}) {
    FollowRig rig;
    if (k < 0.0) rig.settings.bumper.form = BumperSettings::Form::kPublished;
    rig.engage();
    const double surface = rig.tip.p.z() - 0.002;
    Pose X = rig.state.motion.X_ST;
    std::mt19937_64 random(9);
    std::normal_distribution<double> noise(0.0, 0.05);
    double most_force = 0.0, moved_late = 0.0;
    for (int i = 0; i < 1500; ++i) {
      // Down at 50 mm/s to 20 mm below the surface, and pressing on.
      X.p.z() = std::max(surface - 0.02, X.p.z() - 0.05 * rig.settings.motion->dt);
      const double depth = std::max(0.0, surface - rig.tip.p.z());
      press(rig, std::abs(k) * depth + noise(random));
      const double before = rig.tip.p.z();
      rig.follow(X);
      most_force = std::max(most_force, std::abs(k) * depth);
      if (i >= 500) moved_late = std::max(moved_late, std::abs(rig.tip.p.z() - before));
    }
    EXPECT_GT(most_force, 40.0);
    EXPECT_LT(most_force, 200.0) << k;
    // A repeatability of the arm at the most.
    EXPECT_LT(moved_late, 4e-5) << k;
    EXPECT_TRUE(rig.watch.kept());
  }
}

}  // namespace
}  // namespace handrail
