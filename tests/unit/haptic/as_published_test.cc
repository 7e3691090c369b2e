// The mapping and the release of an orientation as the dissertation prints them.
#include <gtest/gtest.h>

#include "server/base/units.h"
#include "tests/unit/constraint/tool_samples.h"
#include "tests/unit/haptic/haptic_rig.h"

namespace handrail {
namespace {

using test::call_of;
using test::HapticRig;

// A tip that points straight down, and the hand of an absolute mapping that asks for just that.
struct AbsoluteRig : HapticRig {
  AbsoluteRig() {
    settings.mapping.absolute = true;
    settings.mapping.hand_centre = Vec3(0.01, 0.02, 0.0);
    settings.mapping.tip_centre = Vec3(0.35, 0.0, 0.43);
    in.slave.X_ST.p = Vec3(0.35, -0.02, 0.45);
    in.slave.X_ST.q = Quat(0.0, 0.0, 1.0, 0.0);
    in.slave.X_ST_command = in.slave.X_ST;
    // 10 mm right of the centre and 10 mm above: device right is -Y, up is +Z, k = 2.
    in.hand.X_MH = {Vec3(0.02, 0.03, 0.0), Quat::Identity()};
  }
};

TEST(AbsoluteMapping, IsTheEquationAsPrinted) {
  const AbsoluteRig rig;
  const Engagement engagement = Engagement::absolute(rig.settings.mapping);
  const Pose tip = engagement.to_slave(rig.in.hand.X_MH);
  EXPECT_TRUE(tip.p.isApprox(Vec3(0.35, -0.02, 0.45), 1e-12)) << tip.p.transpose();
  EXPECT_LT(angle_between(tip.q, Quat(0.0, 0.0, 1.0, 0.0)), 1e-12);
  // The hand turned about the device's up is the tip turned about the base's Z.
  const Pose turned = engagement.to_slave({Vec3::Zero(), rotation_exp({0.0, 0.4, 0.0})});
  EXPECT_LT(angle_between(turned.q, rotation_exp({0.0, 0.0, 0.4}) * Quat(0.0, 0.0, 1.0, 0.0)),
            1e-12);
}

TEST(AbsoluteMapping, EngagesOnlyWhereTheHandAlreadyIsAndSaysHowFarItIsOff) {
  AbsoluteRig rig;
  rig.tick();
  rig.in.hand.X_MH.p.x() += 5e-3;
  EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kHandElsewhere);
  EXPECT_NEAR(rig.out.tool_distance, 10e-3, 1e-9);
  EXPECT_NEAR(rig.out.tool_angle, 0.0, 1e-9);
  rig.in.hand.X_MH.p.x() -= 5e-3;
  rig.in.hand.X_MH.q = rotation_exp({0.0, 0.0, 6.0 * kDeg});
  EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kHandElsewhere);
  EXPECT_NEAR(rig.out.tool_angle, 6.0 * kDeg, 1e-9);
  rig.in.hand.X_MH.q = rotation_exp({0.0, 0.0, 4.9 * kDeg});
  rig.in.hand.X_MH.p.x() += 2.4e-3;
  EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kNone);
  rig.ticks(300);
  EXPECT_EQ(rig.session(), SessionState::kEngaged);
  const Pose asked = Engagement::absolute(rig.settings.mapping).to_slave(rig.in.hand.X_MH);
  EXPECT_LT((rig.command().p - asked.p).norm(), 1e-9) << "no offset stays";
  EXPECT_LT(angle_between(rig.command().q, asked.q), 1e-7);
}

TEST(AbsoluteMapping, AfterTheClutchTheArmWaitsUntilTheHandIsBack) {
  AbsoluteRig rig;
  rig.tick();
  rig.engage();
  rig.ticks(300);
  ASSERT_EQ(rig.session(), SessionState::kEngaged);
  rig.order(OrderKind::kClutchOn);
  rig.ticks(10);
  const Vec3 stood = rig.command().p;
  const Vec3 home = rig.in.hand.X_MH.p;
  for (int i = 0; i < 100; ++i) {
    rig.in.hand.X_MH.p.y() += 1e-4;
    rig.tick();
  }
  rig.order(OrderKind::kClutchOff);
  rig.ticks(50);
  EXPECT_EQ(rig.session(), SessionState::kClutched);
  EXPECT_EQ(rig.out.reason, Reason::kHandElsewhere);
  EXPECT_EQ(rig.command().p, stood);
  for (int i = 0; i < 100; ++i) {
    rig.in.hand.X_MH.p.y() -= 1e-4;
    rig.tick();
  }
  rig.ticks(300);
  EXPECT_EQ(rig.session(), SessionState::kEngaged);
  EXPECT_LT((rig.in.hand.X_MH.p - home).norm(), 1e-9);
  EXPECT_LT((rig.command().p - stood).norm(), 1e-6);
}

TEST(AbsoluteMapping, NeverStepsTheCommandByMoreThanTheHandDoes) {
  AbsoluteRig rig;
  rig.settings.guide.smoother_length = 200;
  rig.tick();
  rig.in.hand.X_MH.p.x() += 2.45e-3;
  rig.engage();
  Vec3 last = rig.command().p;
  for (int i = 0; i < 300; ++i) {
    rig.tick();
    ASSERT_LE((rig.command().p - last).norm(), kAgree / 200 + 1e-12) << i;
    last = rig.command().p;
  }
}

TEST(AbsoluteMapping, AToolWithAReferenceLatchesTheHandAnewWithoutAJump) {
  AbsoluteRig rig;
  rig.tick();
  rig.engage();
  rig.ticks(300);
  rig.order(OrderKind::kClutchOn);
  rig.ticks(5);
  ToolCall upright = call_of(ToolKind::kNRotation);
  upright.has_q_ref = true;
  upright.q_ref = rotation_exp({0.0, 0.3, 0.0}) * Quat(0.0, 0.0, 1.0, 0.0);
  ASSERT_EQ(rig.call(upright), Reason::kNone);
  rig.order(OrderKind::kClutchOff);
  Quat last = rig.command().q;
  for (int i = 0; i < 3000; ++i) {
    rig.tick();
    ASSERT_LE(angle_between(rig.command().q, last), 1.01e-3 * rig.settings.guide.catch_up_rotation);
    last = rig.command().q;
  }
  EXPECT_EQ(rig.session(), SessionState::kEngaged);
  EXPECT_LT(angle_between(rig.command().q, upright.q_ref), 1e-6);
  // The hand is taken to be there: dropped, the tool leaves the arm as it stands.
  ASSERT_EQ(rig.drop(false, true), Reason::kNone);
  rig.ticks(1000);
  EXPECT_LT(angle_between(rig.command().q, upright.q_ref), 1e-6);
}

TEST(Chase, AReleasedOrientationFollowsAtTheGivenSpeedAndLagsBehindAFasterHand) {
  HapticRig rig;
  rig.settings.guide.chase = true;
  rig.settings.guide.smoother_length = 1;
  rig.settings.guide.catch_up_rotation = 10.0 * kDeg;
  rig.tick();
  rig.engage();
  ASSERT_EQ(rig.call(call_of(ToolKind::kNRotation)), Reason::kNone);
  // The hand turns by 20 deg while the tool holds the tip, then it is let go.
  for (int i = 0; i < 200; ++i) {
    rig.in.hand.X_MH.q = rotation_exp({0.0, 0.1 * kDeg, 0.0}) * rig.in.hand.X_MH.q;
    rig.tick();
  }
  const Quat held = rig.command().q;
  ASSERT_EQ(rig.drop(false, true), Reason::kNone);
  rig.ticks(999);
  EXPECT_NEAR(angle_between(rig.command().q, held), 10.0 * kDeg, 0.1 * kDeg);
  EXPECT_TRUE(rig.out.reasons.has(Reason::kToolBlending));
  // A hand that turns on at 20 deg/s is not caught up with: the command goes at 10.
  for (int i = 0; i < 500; ++i) {
    rig.in.hand.X_MH.q = rotation_exp({0.0, 0.02 * kDeg, 0.0}) * rig.in.hand.X_MH.q;
    rig.tick();
  }
  EXPECT_NEAR(angle_between(rig.command().q, held), 15.0 * kDeg, 0.1 * kDeg);
  // It stands, and the command comes: 30 deg in all. From then on it passes 1:1.
  rig.ticks(1600);
  EXPECT_NEAR(angle_between(rig.command().q, held), 30.0 * kDeg, 1e-6);
  EXPECT_FALSE(rig.out.reasons.has(Reason::kToolBlending));
  rig.in.hand.X_MH.q = rotation_exp({0.0, 1.0 * kDeg, 0.0}) * rig.in.hand.X_MH.q;
  rig.ticks(2);
  EXPECT_NEAR(angle_between(rig.command().q, held), 31.0 * kDeg, 1e-6);
}

TEST(Chase, IsOfAReleaseAndAToolStillBringsTheTipToItsReference) {
  HapticRig rig;
  rig.settings.guide.chase = true;
  rig.tick();
  rig.engage();
  ToolCall turned = call_of(ToolKind::kNRotation);
  turned.has_q_ref = true;
  turned.q_ref = rig.command().q * rotation_exp({0.0, 0.2, 0.0});
  ASSERT_EQ(rig.call(turned), Reason::kNone);
  rig.ticks(100);
  EXPECT_TRUE(rig.out.turning);
  rig.ticks(2000);
  EXPECT_FALSE(rig.out.turning);
  EXPECT_LT(angle_between(rig.command().q, turned.q_ref), 1e-6);
}

TEST(Chase, AToolCalledOnTheWayEndsIt) {
  HapticRig rig;
  rig.settings.guide.chase = true;
  rig.tick();
  rig.engage();
  ASSERT_EQ(rig.call(call_of(ToolKind::kNRotation)), Reason::kNone);
  for (int i = 0; i < 200; ++i) {
    rig.in.hand.X_MH.q = rotation_exp({0.0, 0.1 * kDeg, 0.0}) * rig.in.hand.X_MH.q;
    rig.tick();
  }
  ASSERT_EQ(rig.drop(false, true), Reason::kNone);
  rig.ticks(300);
  const Quat there = rig.command().q;
  ASSERT_EQ(rig.call(call_of(ToolKind::kNRotation)), Reason::kNone);
  rig.ticks(3000);
  EXPECT_LT(angle_between(rig.command().q, there), 0.1 * kDeg);
}

}  // namespace
}  // namespace handrail
