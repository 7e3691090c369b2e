// The force on the hand: how it may change, where it comes from, how far it goes.
#include <gtest/gtest.h>

#include "tests/unit/constraint/tool_samples.h"
#include "tests/unit/haptic/haptic_rig.h"

namespace handrail {
namespace {

using test::at;
using test::call_of;
using test::Dice;
using test::HapticRig;
using test::line_call;
using test::plane_call;
using test::Wander;

constexpr double kRounding = 1e-12;

// A tool in its place up to 50 mm from the tip, or turned away by up to 90 degrees.
ToolCall any_tool(Dice& dice, const HapticRig& rig) {
  const Vec3 away = rig.command().p + dice.between(0.0, 0.05) * dice.unit();
  ToolCall call;
  switch (static_cast<int>(dice.between(0.0, 5.0))) {
    case 0: call = at(call_of(ToolKind::kPoint), away); break;
    case 1: call = at(line_call(dice.unit(), dice.between(0, 1) < 0.5), away); break;
    case 2: call = at(plane_call(dice.unit()), away); break;
    case 3: call = call_of(ToolKind::kNRotation); break;
    default:
      call = call_of(ToolKind::kFRotation);
      call.has_axis = true;
      call.axis_S =
          rotation_exp(dice.between(0.0, 1.57) * dice.unit()) * (rig.command().q * Vec3::UnitZ());
  }
  if (dice.between(0, 1) < 0.3) call.stiffness = dice.between(100.0, 2000.0);
  call.approach = dice.between(0, 1) < 0.3;
  return call;
}

double tool_stiffness(const HapticRig& rig) {
  const ToolDefinition& tool = rig.out.link.position_tool;
  return tool.kind == ToolKind::kNone ? rig.settings.guide.stiffness : tool.stiffness;
}

TEST(HapticForce, ChangesByLittleEveryMillisecondAfterAnyToolChange) {
  int changes = 0;
  double most_step = 0.0;
  for (int run = 0; run < 120; ++run) {
    Dice dice(static_cast<std::uint64_t>(700 + run));
    HapticRig rig;
    rig.settings.guide.reach = 0.05 + kRounding;
    rig.settings.has_torque = run % 3 == 0;
    rig.settings.max_torque = 0.1;
    rig.spring_slack = run % 2 == 0;
    rig.engage();
    Wander wander;
    const double speed = run % 4 == 0 ? 0.0 : dice.between(0.02, 0.5);
    for (int change = 0; change < 8; ++change) {
      const int wait = static_cast<int>(dice.between(1.0, 300.0));
      for (int i = 0; i < wait + 500; ++i) {
        wander.move(dice, speed, 3.0 * speed, HapticRig::kTick, rig.in.hand.X_MH);
        if (!rig.spring_slack && i % 7 == 0) {
          rig.in.slave.X_ST.p = rig.command().p + dice.within(0.002);
        }
        if (i == wait) {
          ++changes;
          if (dice.between(0, 1) < 0.3) {
            rig.drop(dice.between(0, 1) < 0.5, dice.between(0, 1) < 0.5);
          } else {
            EXPECT_EQ(rig.call(any_tool(dice, rig)), Reason::kNone);
          }
        } else {
          rig.tick();
        }
        if (i >= wait) {
          most_step = std::max(most_step, rig.force_step - tool_stiffness(rig) * rig.hand_step);
          ASSERT_LE(rig.force_step, 0.05 + tool_stiffness(rig) * rig.hand_step + kRounding)
              << "run " << run << " tick " << i - wait;
        }
      }
    }
    EXPECT_TRUE(rig.finite);
    EXPECT_LT(rig.share_error, kRounding);
    EXPECT_LE(rig.most_force, 3.3 + kRounding);
  }
  EXPECT_EQ(changes, 960);
  EXPECT_GT(most_step, 0.01);  // the bound has been put to the test
}

TEST(HapticForce, AStillHandFeelsNoStepWhenATool50MillimetresOffIsCalled) {
  HapticRig rig;
  rig.settings.guide.reach = 0.06;
  rig.engage();
  rig.call(at(call_of(ToolKind::kPoint), rig.command().p + Vec3(0.05, 0, 0)));
  EXPECT_LE(rig.out.f_H_M.force.norm(), 0.05);
  // 50 mm in S are 25 mm at the hand: more than the device can show, reached by easing.
  for (int i = 0; i < 3000; ++i) {
    rig.tick();
    ASSERT_LE(rig.force_step, 0.05 + kRounding);
  }
  EXPECT_NEAR(rig.out.deviation, 0.025, 1e-4);
  // The tool's share is what it gets of the device, not the 20 N it would take.
  EXPECT_NEAR(rig.out.shares.tool.norm(), rig.out.f_H_M.force.norm(), 0.05);
  EXPECT_LE(rig.out.shares.tool.norm(), 3.3 + kRounding);
  EXPECT_TRUE(rig.out.reasons.has(Reason::kForceClamped) ||
              rig.out.reasons.has(Reason::kForceContinuous));
}

TEST(HapticForce, PullsTheHandTowardTheToolWithItsStiffness) {
  HapticRig rig;
  rig.engage();
  // Direction of the device's X is -Y of the base.
  rig.call(line_call(Vec3::UnitY()));
  rig.in.hand.X_MH.p += Vec3(0, 0.002, 0);
  rig.ticks(300);
  EXPECT_LT((rig.out.f_H_M.force - Vec3(0, -0.8 * 2.0, 0)).norm(), 1e-9);
  EXPECT_NEAR(rig.out.deviation, 0.002, 1e-12);
  // Along the line nothing pulls.
  rig.in.hand.X_MH.p += Vec3(0.02, 0, 0);
  rig.ticks(600);
  EXPECT_LT((rig.out.f_H_M.force - Vec3(0, -0.8 * 2.0, 0)).norm(), 1e-9);
}

TEST(HapticForce, TheSpringPullsTheHandTowardWhereTheRobotIs) {
  HapticRig rig;
  rig.spring_slack = false;
  rig.engage();
  // The robot is held 20 mm back in -X of the base: +Z of the device, 10 mm at the hand, 2 N.
  rig.in.slave.X_ST.p = rig.command().p - Vec3(0.02, 0, 0);
  rig.ticks(100);
  EXPECT_LT((rig.out.f_H_M.force - Vec3(0, 0, 2.0)).norm(), 1e-9);
  EXPECT_LT((rig.out.shares.spring - Vec3(0, 0, 2.0)).norm(), 1e-9);
  EXPECT_LT(rig.out.shares.tool.norm(), 1e-12);
}

TEST(HapticForce, TheToolIsServedFirstAndTheSpringSaysItGaveWay) {
  HapticRig rig;
  rig.spring_slack = false;
  rig.engage();
  rig.call(line_call(Vec3::UnitY()));
  rig.in.hand.X_MH.p += Vec3(0, 0.003, 0);                   // 2.4 N of tool
  rig.in.slave.X_ST.p = rig.command().p - Vec3(0.03, 0, 0);  // 3 N of spring
  rig.ticks(300);
  EXPECT_NEAR(rig.out.f_H_M.force.y(), -2.4, 1e-9);
  EXPECT_NEAR(rig.out.f_H_M.force.norm(), 3.3, 1e-9);
  EXPECT_TRUE(rig.out.reasons.has(Reason::kForceBudget));
  EXPECT_LT(
      (rig.out.shares.tool + rig.out.shares.spring + rig.out.shares.limited - rig.out.shares.device)
          .norm(),
      kRounding);
}

TEST(HapticForce, FallsToTheContinuousForceWhenHeldForLong) {
  HapticRig rig;
  rig.engage();
  rig.call(line_call(Vec3::UnitY()));
  rig.in.hand.X_MH.p += Vec3(0, 0.02, 0);
  rig.ticks(300);
  EXPECT_NEAR(rig.out.f_H_M.force.norm(), 3.3, 1e-9);
  for (int i = 0; i < 60000; ++i) {
    rig.tick();
    ASSERT_LE(rig.force_step, 0.05 + kRounding);
  }
  EXPECT_NEAR(rig.out.f_H_M.force.norm(), 0.88, 0.01);
  EXPECT_TRUE(rig.out.reasons.has(Reason::kForceContinuous));
  // A rested motor gives its peak again.
  rig.drop(true, true);
  rig.ticks(60000);
  rig.call(line_call(Vec3::UnitY()));
  rig.in.hand.X_MH.p += Vec3(0, 0.02, 0);
  rig.ticks(300);
  EXPECT_NEAR(rig.out.f_H_M.force.norm(), 3.3, 1e-9);
}

TEST(HapticForce, IsGoneWithin50MillisecondsOfAHoldWhateverItWas) {
  for (const int push : {1, 4, 100}) {
    HapticRig rig;
    rig.engage();
    rig.call(line_call(Vec3::UnitY()));
    rig.in.hand.X_MH.p += Vec3(0, 1e-3 * push, 0);
    rig.ticks(300);
    EXPECT_GT(rig.out.f_H_M.force.norm(), 0.7);
    rig.in.slave_age = 20 * kMillisecond + 1;
    rig.ticks(50);
    EXPECT_LT(rig.out.f_H_M.force.norm(), 1e-9);
    EXPECT_TRUE(rig.out.reasons.has(Reason::kForceFaded));
    // The hand moves on against no stale force.
    rig.in.hand.X_MH.p += Vec3(0, 0.01, 0);
    rig.tick();
    EXPECT_LT(rig.out.f_H_M.force.norm(), 1e-9);
  }
}

TEST(HapticForce, IsGoneWithin50MillisecondsOfAStopAndOfALostPose) {
  for (const bool stop : {false, true}) {
    HapticRig rig;
    rig.engage();
    rig.call(line_call(Vec3::UnitY()));
    rig.in.hand.X_MH.p += Vec3(0, 0.01, 0);
    rig.ticks(300);
    if (stop) {
      rig.order(OrderKind::kStop);
    } else {
      rig.in.slave.has_pose = false;
    }
    rig.ticks(50);
    EXPECT_LT(rig.out.f_H_M.force.norm(), 1e-9) << stop;
  }
}

TEST(HapticForce, LeavesAndComesWithoutAStepAroundAClutch) {
  HapticRig rig;
  rig.engage();
  rig.call(line_call(Vec3::UnitY()));
  rig.in.hand.X_MH.p += Vec3(0, 0.004, 0);
  rig.ticks(300);
  rig.in.hand.clutch_button = true;
  for (int i = 0; i < 200; ++i) {
    rig.tick();
    ASSERT_LE(rig.force_step, 0.05 + kRounding) << i;
  }
  EXPECT_EQ(rig.out.f_H_M.force, Vec3(Vec3::Zero()));
  rig.in.hand.X_MH.p += Vec3(0, 0.03, 0);
  rig.ticks(10);
  rig.in.hand.clutch_button = false;
  for (int i = 0; i < 500; ++i) {
    rig.tick();
    ASSERT_LE(rig.force_step, 0.05 + kRounding) << i;
  }
  // The line is still there, and re-engaged hands start on it.
  EXPECT_LT(rig.out.f_H_M.force.norm(), 1e-9);
  rig.in.hand.X_MH.p += Vec3(0, 0.001, 0);
  rig.ticks(100);
  EXPECT_NEAR(rig.out.f_H_M.force.y(), -0.8, 1e-9);
}

// One that came by the step limit alone would push on a hand that has turned back by then.
TEST(HapticForce, ADamperComesWithTheHandAndGoesWithIt) {
  HapticRig rig;
  rig.settings.damping = 20.0;
  rig.engage();
  rig.call(line_call({1, 0, 0}));
  rig.ticks(50);
  for (const double speed : {0.1, -0.1, 0.0}) {
    rig.in.hand.v_MH = {speed, 0.0, 0.0};
    rig.tick();
    EXPECT_NEAR(rig.out.f_H_M.force.x(), -20.0 * speed, 0.05) << speed;
  }
  // Without a tool nothing follows it: there is no damper.
  HapticOrder off;
  off.kind = OrderKind::kToolOff;
  rig.in.hand.v_MH = {0.1, 0.0, 0.0};
  rig.ticks(50);
  rig.in.order = off;
  rig.tick();
  EXPECT_NEAR(rig.out.f_H_M.force.x(), -2.0 + 0.05, 1e-6);
}

TEST(HapticForce, DampingOpposesTheHandsVelocityOnAToolOnly) {
  HapticRig rig;
  rig.settings.damping = 2.0;
  rig.engage();
  rig.in.hand.v_MH = Vec3(0, 0.1, 0);
  rig.ticks(50);
  EXPECT_EQ(rig.out.f_H_M.force.norm(), 0.0);
  rig.call(line_call(Vec3::UnitY()));
  rig.ticks(50);
  EXPECT_LT((rig.out.f_H_M.force - Vec3(0, -0.2, 0)).norm(), 1e-9);
}

TEST(HapticTorque, ADeviceWithTorqueFeelsTheWayBackWithinItsLimitsAndWithoutSteps) {
  HapticRig rig;
  rig.settings.has_torque = true;
  rig.settings.max_torque = 0.1;
  rig.engage();
  rig.call(call_of(ToolKind::kNRotation));
  rig.in.hand.X_MH.q = rotation_exp({0, 0.1, 0}) * rig.in.hand.X_MH.q;
  Vec3 last = rig.out.f_H_M.torque;
  for (int i = 0; i < 300; ++i) {
    rig.tick();
    // It follows the hand at once, by K_N |turn|, and comes up with a tool within the fade time.
    ASSERT_LE((rig.out.f_H_M.torque - last).norm(),
              0.1 / 25.0 + (i == 0 ? 0.5 * 0.1 : 0.0) + kRounding);
    last = rig.out.f_H_M.torque;
  }
  EXPECT_LT((last - Vec3(0, -0.05, 0)).norm(), 1e-9);  // (3.5): K_N = 0.5 N m/rad
  rig.in.hand.X_MH.q = rotation_exp({0, 2.0, 0}) * rig.in.hand.X_MH.q;
  rig.ticks(300);
  EXPECT_NEAR(rig.out.f_H_M.torque.norm(), 0.1, 1e-9);
}

TEST(HapticTorque, StaysContinuousWhereTheWayBackChangesSides) {
  HapticRig rig;
  rig.settings.has_torque = true;
  rig.settings.max_torque = 0.1;
  for (const ToolKind kind : {ToolKind::kNRotation, ToolKind::kFRotation}) {
    rig.engage();
    rig.call(call_of(kind));
    Vec3 last = rig.out.f_H_M.torque;
    for (int i = 0; i < 2000; ++i) {
      rig.in.hand.X_MH.q = (rotation_exp({4e-3, 0, 0}) * rig.in.hand.X_MH.q).normalized();
      rig.tick();
      ASSERT_LE((rig.out.f_H_M.torque - last).norm(), 0.1 / 25.0 + 0.5 * 4e-3 + kRounding);
      ASSERT_LE(rig.out.f_H_M.torque.norm(), 0.1 + kRounding);
      last = rig.out.f_H_M.torque;
    }
  }
}

TEST(HapticTorque, IsNoStifferThanTheDeviceHolds) {
  HapticRig rig;
  rig.settings.has_torque = true;
  rig.settings.max_torque = 1.0;
  rig.settings.guide.most_torque_stiffness = 0.2;
  rig.engage();
  rig.call(call_of(ToolKind::kNRotation));
  rig.in.hand.X_MH.q = rotation_exp({0, 0.1, 0}) * rig.in.hand.X_MH.q;
  rig.ticks(300);
  EXPECT_LT((rig.out.f_H_M.torque - Vec3(0, -0.02, 0)).norm(), 1e-9);
}

TEST(HapticTorque, IsGoneWhereTheLoopIsTooSlowForForce) {
  HapticRig rig;
  rig.settings.ladder.fade_loop = 300 * kMillisecond;
  rig.settings.has_torque = true;
  rig.settings.max_torque = 0.1;
  rig.engage();
  rig.call(call_of(ToolKind::kNRotation));
  rig.in.hand.X_MH.q = rotation_exp({0, 0.1, 0}) * rig.in.hand.X_MH.q;
  rig.ticks(300);
  ASSERT_GT(rig.out.f_H_M.torque.norm(), 0.049);
  rig.in.link.loop_age = 500 * kMillisecond;
  rig.ticks(1500);
  ASSERT_EQ(rig.session(), SessionState::kEngaged);
  EXPECT_EQ(rig.out.f_H_M.torque.norm(), 0.0);
}

TEST(HapticTorque, ADeviceWithoutTorqueGetsNone) {
  HapticRig rig;
  rig.engage();
  rig.call(call_of(ToolKind::kNRotation));
  rig.in.hand.X_MH.q = rotation_exp({0, 1.0, 0}) * rig.in.hand.X_MH.q;
  rig.ticks(100);
  EXPECT_EQ(rig.out.f_H_M.torque, Vec3(Vec3::Zero()));
  EXPECT_NEAR(rig.out.deviation_angle, 1.0, 1e-9);
}

}  // namespace
}  // namespace handrail
