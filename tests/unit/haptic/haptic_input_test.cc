// What no device and no peer should send, sent: the step stays finite, bounded and says so.
#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/constraint/tool_samples.h"
#include "tests/unit/haptic/haptic_rig.h"

namespace handrail {
namespace {

using test::call_of;
using test::Dice;
using test::HapticRig;
using test::line_call;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kHuge = 1e308;

// Engaged on a line, hand pushed 2 mm off it.
void push_on_line(HapticRig& rig) {
  rig.engage();
  rig.call(line_call(Vec3::UnitY()));
  rig.in.hand.X_MH.p += Vec3(0, 0.002, 0);
  rig.ticks(400);
}

TEST(HapticInput, NoBadHandReadingEverReachesForceOrCommand) {
  const auto spoilt = [](int what, Pose X, Vec3& v) {
    switch (what) {
      case 0: X.p.x() = kNaN; break;
      case 1: X.p.z() = -kInfinity; break;
      case 2: X.p.y() = kHuge; break;
      case 3: X.q.w() = kNaN; break;
      case 4: X.q = Quat(0, 0, 0, 0); break;
      case 5: X.q = Quat(2, 0, 0, 0); break;
      case 6: v = Vec3(kNaN, 0, 0); break;
      case 7: v = Vec3(0, kHuge, 0); break;
      default: X.p.x() = 50.0;
    }
    return X;
  };
  for (int what = 0; what < 9; ++what) {
    HapticRig rig;
    rig.settings.damping = 2.0;
    push_on_line(rig);
    const Pose good = rig.in.hand.X_MH, command = rig.command();
    rig.in.hand.X_MH = spoilt(what, good, rig.in.hand.v_MH);
    rig.tick();
    EXPECT_TRUE(rig.finite);
    EXPECT_TRUE(rig.out.reasons.has(Reason::kDeviceInvalid)) << what;
    EXPECT_EQ(rig.out.f_H_M.force, Vec3(Vec3::Zero())) << what;
    EXPECT_LT((rig.command().p - command.p).norm(), 1e-9) << what;
    // The next good reading counts again, and the force comes back without a step.
    rig.in.hand.X_MH = good;
    rig.in.hand.v_MH.setZero();
    for (int i = 0; i < 300; ++i) {
      rig.tick();
      ASSERT_LE(rig.force_step, 0.05 + 1e-12);
      ASSERT_LT((rig.command().p - command.p).norm(), 1e-9);
    }
    EXPECT_NEAR(rig.out.f_H_M.force.norm(), 1.6, 1e-6) << what;
    EXPECT_FALSE(rig.out.reasons.has(Reason::kDeviceInvalid));
  }
}

TEST(HapticInput, AHandThatComesBackElsewhereAfterASilenceTakesOverLikeAfterAClutch) {
  HapticRig rig;
  push_on_line(rig);
  rig.in.hand.valid = false;
  rig.ticks(100);
  EXPECT_EQ(rig.out.reason, Reason::kDeviceInvalid);
  const Pose frozen = rig.command();
  rig.in.hand.X_MH.p += Vec3(0.08, -0.05, 0.1);
  rig.in.hand.X_MH.q = rotation_exp({1.0, 0, 0}) * rig.in.hand.X_MH.q;
  rig.in.hand.valid = true;
  for (int i = 0; i < 500; ++i) {
    rig.tick();
    ASSERT_LT((rig.command().p - frozen.p).norm(), 1e-12);
    ASSERT_LT(angle_between(rig.command().q, frozen.q), 1e-12);
    ASSERT_LT(rig.out.f_H_M.force.norm(), 1e-9);
  }
}

// A device that was lost and is homed anew may have its middle elsewhere: the same hand reads as 60
// mm off. With a dead-man's switch the arm waits meanwhile, and after two seconds it is engaged by
// nobody but the operator.
TEST(HapticInput, ADeviceThatComesBackWithAnotherMiddleMovesNothing) {
  for (const bool button : {false, true}) {
    for (const int away : {100, 2500}) {
      HapticRig rig;
      if (button) rig.settings.presence = Presence::kButton;
      rig.in.hand.enable_button = button;
      rig.settings.guide.smoother_length = 1;
      rig.engage();
      ASSERT_EQ(rig.session(), SessionState::kEngaged);
      const Pose frozen = rig.command();
      rig.in.hand.valid = false;
      for (int i = 0; i < away; ++i) {
        rig.tick();
        ASSERT_LT((rig.command().p - frozen.p).norm(), 1e-12);
      }
      const bool off = button && away > 2000;
      EXPECT_EQ(rig.session(), off      ? SessionState::kOff
                               : button ? SessionState::kClutched
                                        : SessionState::kEngaged);
      rig.in.hand.X_MH.p += Vec3(0.06, -0.06, 0.0);
      rig.in.hand.valid = true;
      for (int i = 0; i < 500; ++i) {
        rig.tick();
        ASSERT_LT((rig.command().p - frozen.p).norm(), 1e-12);
      }
      EXPECT_EQ(rig.session(), off ? SessionState::kOff : SessionState::kEngaged);
      // From there it leads.
      rig.in.hand.X_MH.p += Vec3(0.0, 0.001, 0.0);
      rig.ticks(10);
      EXPECT_NEAR((rig.command().p - frozen.p).norm(), off ? 0.0 : 0.002, 1e-9);
    }
  }
}

// Or it was lost and is back about the time in which the loop itself stood still: no reading was
// invalid, the one before that time, or the one after it.
TEST(HapticInput, NorDoesOneThatDidSoWhileTheLoopStoodStill) {
  for (const int invalid : {0, 1, 2}) {
    for (const Nanos unseen : {(invalid == 0 ? 101 : 22) * kMillisecond, 150 * kMillisecond}) {
      HapticRig rig;
      rig.settings.guide.smoother_length = 1;
      rig.engage();
      const Pose frozen = rig.command();
      rig.in.hand.valid = invalid == 0;
      rig.in.unseen = invalid == 2 ? unseen : kMillisecond;
      if (invalid > 0) rig.tick();
      rig.in.hand.valid = true;
      rig.in.hand.X_MH.p += Vec3(0.06, -0.06, 0.0);
      rig.in.unseen = invalid == 2 ? kMillisecond : unseen;
      for (int i = 0; i < 1000; ++i) {
        rig.tick();
        rig.in.unseen = kMillisecond;
        ASSERT_LT((rig.command().p - frozen.p).norm(), 1e-12) << i;
      }
      EXPECT_EQ(rig.session(), SessionState::kEngaged);
      rig.in.hand.X_MH.p += Vec3(0.0, 0.001, 0.0);
      rig.ticks(10);
      EXPECT_NEAR((rig.command().p - frozen.p).norm(), 0.002, 1e-9) << "from there it leads";
    }
  }
}

TEST(HapticInput, AHandIsFollowedOverATickThatIsLate) {
  HapticRig rig;
  rig.settings.guide.smoother_length = 1;
  rig.engage();
  const Pose before = rig.command();
  rig.in.hand.X_MH.p += Vec3(0.0, 0.002, 0.0);
  rig.in.unseen = 15 * kMillisecond;
  rig.tick();
  EXPECT_NEAR((rig.command().p - before.p).norm(), 0.004, 1e-9);
}

TEST(HapticInput, OneMissedReadingDoesNotInterruptTheMotion) {
  HapticRig rig;
  rig.settings.guide.smoother_length = 1;
  rig.engage();
  const double start = rig.command().p.z();
  for (int i = 0; i < 100; ++i) {
    rig.in.hand.X_MH.p.y() += 1e-4;
    rig.in.hand.valid = i % 10 != 5;
    rig.tick();
  }
  EXPECT_NEAR(rig.command().p.z() - start, 0.02, 1e-12);
}

TEST(HapticInput, AnEngagementIsRefusedWithoutAHand) {
  HapticRig rig;
  rig.in.hand.valid = false;
  EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kDeviceInvalid);
  rig.in.hand.valid = true;
  rig.ticks(10);
  EXPECT_EQ(rig.session(), SessionState::kOff);
}

TEST(HapticInput, ASlaveStateThatIsNoPoseGivesNoForceAndNoCommand) {
  for (const double bad : {kNaN, kInfinity, kHuge, 1e200, 100.0}) {
    HapticRig rig;
    rig.spring_slack = false;
    push_on_line(rig);
    const Pose command = rig.command();
    const Pose good = rig.in.slave.X_ST;
    rig.in.slave.X_ST.p.x() = bad;
    for (int i = 0; i < 100; ++i) {
      rig.tick();
      ASSERT_TRUE(rig.finite) << bad;
      // It fades, as any force that has lost its reason.
      ASSERT_LE(rig.force_step, 3.3 / 25.0 + 1e-12) << bad;
    }
    EXPECT_LT(rig.out.f_H_M.force.norm(), 1e-9);
    EXPECT_TRUE(rig.out.reasons.has(Reason::kForceFaded));
    EXPECT_LT((rig.command().p - command.p).norm(), 1e-9);
    rig.in.slave.X_ST = good;
    rig.ticks(200);
    EXPECT_NEAR(rig.out.f_H_M.force.norm(), 1.6, 1e-6);
  }
}

TEST(HapticInput, ASlaveThatStandsNowhereIsNotEngaged) {
  for (const double bad : {kNaN, kHuge}) {
    HapticRig rig;
    rig.in.slave.X_ST_command.p.y() = bad;
    rig.order(OrderKind::kEngage);
    rig.ticks(20);
    EXPECT_NE(rig.session(), SessionState::kEngaged);
    EXPECT_FALSE(rig.out.link.has_command);
    EXPECT_TRUE(rig.finite);
  }
}

TEST(HapticInput, StaysFiniteAndBoundedUnderAStormOfEverything) {
  Dice dice(1500);
  HapticRig rig;
  rig.settings.has_torque = true;
  rig.settings.max_torque = 0.1;
  const double odd[] = {kNaN, kInfinity, -kInfinity, kHuge, -kHuge, 1e-320, 0.0};
  const auto pick = [&] { return odd[static_cast<std::size_t>(dice.between(0, 6.999))]; };
  for (int i = 0; i < 20000; ++i) {
    const Pose hand = rig.in.hand.X_MH;
    const SlaveState slave = rig.in.slave;
    if (dice.between(0, 1) < 0.1) rig.in.hand.X_MH.p[i % 3] = pick();
    if (dice.between(0, 1) < 0.05) rig.in.hand.X_MH.q.coeffs()[i % 4] = pick();
    if (dice.between(0, 1) < 0.05) rig.in.slave.X_ST.p[i % 3] = pick();
    if (dice.between(0, 1) < 0.05) rig.in.slave.X_ST_command.q.coeffs()[i % 4] = pick();
    rig.in.slave_age = dice.between(0, 1) < 0.01 ? from_seconds(dice.between(0, 0.3)) : 0;
    rig.in.order.kind = dice.between(0, 1) < 0.1
                            ? static_cast<OrderKind>(static_cast<int>(dice.between(0, 8.999)))
                            : OrderKind::kEngage;
    rig.in.order.tool = call_of(static_cast<ToolKind>(static_cast<int>(dice.between(0, 5.999))));
    rig.in.order.tool.direction_S = rig.in.order.tool.normal_S = dice.unit();
    if (dice.between(0, 1) < 0.2) rig.in.order.tool.direction_S[i % 3] = pick();
    if (dice.between(0, 1) < 0.2) rig.in.order.tool.stiffness = pick();
    rig.tick();
    ASSERT_TRUE(rig.finite) << i;
    ASSERT_LE(rig.most_force, 3.3 + 1e-12) << i;
    ASSERT_LE(rig.out.f_H_M.torque.norm(), 0.1 + 1e-12) << i;
    rig.in.hand.X_MH = hand;
    rig.in.hand.X_MH.p = dice.within(0.1);
    const SessionState played = rig.in.slave.state;
    rig.in.slave = slave;
    rig.in.slave.state = played;
    if (i % 50 == 0) rig.order(OrderKind::kReset);
  }
}

}  // namespace
}  // namespace handrail
