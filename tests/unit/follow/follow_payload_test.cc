// What hangs on the sensor, in the slave's step.
#include <gtest/gtest.h>

#include "tests/unit/follow/follow_rig.h"

namespace handrail {
namespace {

using test::FollowRig;
using test::home;
using test::joints_deg;

const Payload kHeavy{2.0, {0.01, -0.02, 0.05}, {{3.0, -1.0, 2.0}, {0.1, 0.2, -0.3}}};

// What a sensor with that payload reads while the arm is at `q` and the environment pushes.
Wrench reading(const FollowRig& rig, const JointVector& q, const Vec3& push_S) {
  const Mat3 R = forward(rig.settings.motion->arm, q).q.toRotationMatrix();
  const Vec3 weight = R.transpose() * Vec3(0, 0, -9.80665 * kHeavy.mass);
  return {weight + kHeavy.bias_T.force + R.transpose() * push_S,
          kHeavy.centre_T.cross(weight) + kHeavy.bias_T.torque};
}

TEST(FollowPayload, OnlyTheEnvironmentsPartIsLeftHoweverTheWristIsTurned) {
  for (const double turn : {-100.0, -30.0, 0.0, 45.0, 110.0}) {
    const JointVector q = home() + joints_deg(0, 0, 0, turn, 0.2 * turn, -turn);
    FollowRig rig(q);
    rig.settings.payload = kHeavy;
    for (const Vec3& push : {Vec3(0, 0, 0), Vec3(5, -7, 20)}) {
      rig.in.f_E_T = reading(rig, q, push);
      rig.cycle();
      EXPECT_LT((rig.out.link.f_E_S.force - push).norm(), 1e-9);
      EXPECT_LT(rig.out.link.f_E_S.torque.norm(), 1e-9);
      EXPECT_TRUE(rig.out.link.payload_removed);
    }
  }
}

// The sensor sits between flange and tool, and is turned as the flange is.
TEST(FollowPayload, ATipThatIsMountedTurnedFeelsWhatTheEnvironmentDoes) {
  FollowRig straight;
  FollowRig rig;
  MotionSettings bent = rig.settings.motion.settings();
  bent.arm.X_AT = Pose{Vec3(0.04, -0.02, 0.03), rotation_exp({0.4, 1.0, -0.3})};
  rig.settings.motion = bent;
  rig.settings.payload = kHeavy;
  place(rig.settings, home(), rig.state);
  for (const Vec3& push : {Vec3(0, 0, 0), Vec3(5, -7, 20)}) {
    rig.in.f_E_T = reading(straight, home(), push);
    rig.cycle();
    EXPECT_LT((rig.out.link.f_E_S.force - push).norm(), 1e-9);
    EXPECT_LT(rig.out.link.f_E_S.torque.norm(), 1e-9);
  }
}

TEST(FollowPayload, WithoutOneTheReadingStandsAsItIs) {
  FollowRig rig;
  rig.in.f_E_T = {{0.1, 0.2, 0.3}, {0.4, 0.5, 0.6}};
  rig.cycle();
  const Quat q = rig.state.motion.X_ST.q;
  EXPECT_EQ(rig.out.link.f_E_S.force, Vec3(q * rig.in.f_E_T.force));
  EXPECT_EQ(rig.out.link.f_E_S.torque, Vec3(q * rig.in.f_E_T.torque));
  EXPECT_FALSE(rig.out.link.payload_removed);
}

TEST(FollowPayload, GravityIsTakenFromWhereTheArmIsNotFromWhereItIsTold) {
  FollowRig rig;
  rig.settings.payload = kHeavy;
  const JointVector behind = home() + joints_deg(0, 0, 0, 0, -1.0, 0);
  rig.in.q_measured = behind;
  rig.in.f_E_T = reading(rig, behind, Vec3::Zero());
  rig.cycle();
  EXPECT_LT(rig.out.link.f_E_S.force.norm(), 1e-9);
}

// An arm that turns is turned less far than it is told.
TEST(FollowPayload, TheForceIsTurnedByWhereTheArmIsNotByWhereItIsTold) {
  for (const bool loaded : {false, true}) {
    FollowRig rig;
    if (loaded) rig.settings.payload = kHeavy;
    const JointVector behind = home() + joints_deg(0, 0, 0, 0, -4.0, 2.0);
    const Quat q_ST = forward(rig.settings.motion->arm, behind).q;
    const Vec3 push(5.0, -7.0, 20.0), turn(0.5, 0.2, -0.3);
    rig.in.q_measured = behind;
    rig.in.f_E_T =
        loaded ? reading(rig, behind, push) : Wrench{q_ST.conjugate() * push, Vec3::Zero()};
    rig.in.f_E_T.torque += q_ST.conjugate() * turn;
    rig.cycle();
    EXPECT_LT((rig.out.link.f_E_S.force - push).norm(), 1e-9) << loaded;
    EXPECT_LT((rig.state.f_E_S - push).norm(), 1e-9) << loaded;
    EXPECT_LT((rig.out.link.f_E_S.torque - turn).norm(), 1e-9) << loaded;
  }
}

TEST(FollowPayload, TheSensorsRangeIsJudgedWithTheLoadOnIt) {
  FollowRig rig;
  rig.settings.payload = kHeavy;
  rig.settings.payload.bias_T.force.x() = 90.0;
  rig.settings.sensor_range = 100.0;
  rig.in.f_E_T = reading(rig, home(), Vec3::Zero());
  rig.in.f_E_T.force.x() = 101.0;  // 11 N of it are the environment's
  for (int i = 0; i < 5; ++i) rig.cycle();
  EXPECT_FALSE(rig.out.link.has_wrench);
  rig.in.f_E_T.force.x() = -20.0;  // -110 N, but the sensor reads 20
  for (int i = 0; i < 5; ++i) rig.cycle();
  EXPECT_TRUE(rig.out.link.has_wrench);
}

}  // namespace
}  // namespace handrail
