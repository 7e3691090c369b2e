// Engaging, clutching, stopping and refusing, seen from outside the master's step.
#include <gtest/gtest.h>

#include "tests/unit/constraint/tool_samples.h"
#include "tests/unit/haptic/haptic_rig.h"

namespace handrail {
namespace {

using test::call_of;
using test::Dice;
using test::HapticRig;
using test::line_call;

constexpr double kStill = 1e-15;

bool same_pose(const Pose& a, const Pose& b) {
  return (a.p - b.p).norm() < kStill && std::min((a.q.coeffs() - b.q.coeffs()).norm(),
                                                 (a.q.coeffs() + b.q.coeffs()).norm()) < kStill;
}

TEST(HapticSession, CommandsNothingBeforeItHasEngaged) {
  HapticRig rig;
  Dice dice(61);
  for (int i = 0; i < 100; ++i) {
    rig.in.hand.X_MH.p = dice.within(0.1);
    rig.tick();
    EXPECT_EQ(rig.session(), SessionState::kOff);
    EXPECT_EQ(rig.out.reason, Reason::kNotEngaged);
    EXPECT_FALSE(rig.out.link.has_command);
    EXPECT_EQ(rig.out.f_H_M.force, Vec3(Vec3::Zero()));
  }
}

TEST(HapticSession, NamesTheJointThatKeepsTheSlaveFromBeingEngaged) {
  HapticRig rig;
  rig.in.slave.obstacle = rig.in.slave.reason = Reason::kEncoderInvalid;
  rig.in.slave.ledger.joint = 2;
  rig.in.slave.has_pose = false;
  EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kEncoderInvalid);
  EXPECT_EQ(rig.out.motion.joint, 2);
}

TEST(HapticSession, EngagingWithAStillHandMovesTheCommandByNothing) {
  for (const int length : {1, 105, 200}) {
    HapticRig rig;
    rig.settings.guide.smoother_length = length;
    const Pose tip = rig.in.slave.X_ST_command;
    EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kNone);
    int engaged = 0;
    for (int i = 0; i < 1000; ++i) {
      if (rig.out.link.has_command) {
        EXPECT_TRUE(same_pose(rig.command(), tip)) << i;
      }
      engaged += rig.session() == SessionState::kEngaged ? 1 : 0;
      rig.tick();
    }
    EXPECT_GT(engaged, 990);
    EXPECT_EQ(rig.most_force, 0.0);
  }
}

TEST(HapticSession, AligningCopiesThePoseTheSlaveStandsOnEvenWhileTheHandMoves) {
  HapticRig rig;
  rig.play_slave = false;
  const Pose tip = rig.in.slave.X_ST_command;
  rig.order(OrderKind::kEngage);
  Dice dice(62);
  for (int i = 0; i < 50; ++i) {
    rig.in.hand.X_MH.p += dice.within(0.01);
    rig.tick();
    EXPECT_EQ(rig.session(), SessionState::kAligning);
    EXPECT_TRUE(same_pose(rig.command(), tip));
  }
  rig.in.slave.state = SessionState::kEngaged;
  rig.in.slave.engagement_epoch = rig.out.link.engagement_epoch;
  rig.tick();
  EXPECT_EQ(rig.session(), SessionState::kEngaged);
  EXPECT_TRUE(same_pose(rig.command(), tip));
}

TEST(HapticSession, AClutchFreezesTheCommandWhileTheHandMoves) {
  for (const bool by_button : {false, true}) {
    HapticRig rig;
    Dice dice(63);
    rig.engage();
    for (int i = 0; i < 50; ++i) rig.in.hand.X_MH.p += dice.within(1e-3), rig.tick();
    const auto clutch = [&](bool on) {
      if (by_button) {
        rig.in.hand.clutch_button = on;
        rig.tick();
      } else {
        EXPECT_EQ(rig.order(on ? OrderKind::kClutchOn : OrderKind::kClutchOff), Reason::kNone);
      }
    };
    clutch(true);
    const Pose frozen = rig.command();
    EXPECT_EQ(rig.session(), SessionState::kClutched);
    for (int i = 0; i < 500; ++i) {
      rig.in.hand.X_MH.p += dice.within(1e-3);
      rig.in.hand.X_MH.q = (rotation_exp(dice.within(0.02)) * rig.in.hand.X_MH.q).normalized();
      rig.tick();
      ASSERT_TRUE(same_pose(rig.command(), frozen));
      ASSERT_EQ(rig.out.link.desired, Desired::kClutched);
    }
    EXPECT_EQ(rig.out.f_H_M.force, Vec3(Vec3::Zero()));
    // Re-clutching with a still hand, at quite another pose than before, moves nothing either.
    clutch(false);
    for (int i = 0; i < 500; ++i) {
      rig.tick();
      ASSERT_TRUE(same_pose(rig.command(), frozen));
    }
    EXPECT_EQ(rig.session(), SessionState::kEngaged);
  }
}

// A gap of the link in the middle of a clutch must not give the arm to the hand.
TEST(HapticSession, AClutchStaysFrozenThroughALinkHold) {
  HapticRig rig;
  Dice dice(64);
  rig.engage();
  rig.order(OrderKind::kClutchOn);
  rig.ticks(3);
  const Pose frozen = rig.command();
  for (int i = 0; i < 300; ++i) {
    rig.in.slave_age = i < 100 ? 0 : i < 200 ? 30 * kMillisecond : 0;
    rig.in.hand.X_MH.p += dice.within(1e-3);
    rig.tick();
    EXPECT_EQ(rig.session(), i / 100 == 1 ? SessionState::kHold : SessionState::kClutched);
    ASSERT_TRUE(same_pose(rig.command(), frozen)) << i;
  }
}

TEST(HapticSession, AClutchTakenDuringALinkHoldFreezesAndReleasesWithoutAJump) {
  HapticRig rig;
  rig.engage();
  rig.in.slave_age = 30 * kMillisecond;
  rig.ticks(5);
  rig.in.hand.clutch_button = true;
  rig.tick();
  const Pose frozen = rig.command();
  rig.in.hand.X_MH.p += Vec3(0.05, 0, 0);
  rig.ticks(10);
  EXPECT_TRUE(same_pose(rig.command(), frozen));
  rig.in.slave_age = 0;
  rig.ticks(10);
  rig.in.hand.clutch_button = false;
  rig.ticks(300);
  EXPECT_EQ(rig.session(), SessionState::kEngaged);
  EXPECT_TRUE(same_pose(rig.command(), frozen));
}

TEST(HapticSession, AShortGapHoldsAndResumesByItself) {
  HapticRig rig;
  rig.engage();
  rig.in.slave_age = 20 * kMillisecond;
  rig.tick();
  EXPECT_EQ(rig.session(), SessionState::kEngaged);
  EXPECT_EQ(rig.out.reason, Reason::kLinkStale);
  rig.in.slave_age = 20 * kMillisecond + 1;
  rig.tick();
  EXPECT_EQ(rig.session(), SessionState::kHold);
  EXPECT_EQ(rig.out.reason, Reason::kLinkHold);
  rig.in.slave_age = 200 * kMillisecond;
  rig.tick();
  EXPECT_EQ(rig.session(), SessionState::kHold);
  rig.in.slave_age = 0;
  rig.tick();
  EXPECT_EQ(rig.session(), SessionState::kEngaged);
}

TEST(HapticSession, ALostLinkLatchesUntilResetAndSaysSo) {
  HapticRig rig;
  rig.engage();
  rig.in.slave_age = 200 * kMillisecond + 1;
  rig.tick();
  EXPECT_EQ(rig.session(), SessionState::kFault);
  rig.in.slave_age = 0;
  rig.ticks(10);
  EXPECT_EQ(rig.session(), SessionState::kFault);
  EXPECT_EQ(rig.out.reason, Reason::kLinkLost);
  EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kLinkLost);
  EXPECT_EQ(rig.order(OrderKind::kReset), Reason::kNone);
  EXPECT_EQ(rig.session(), SessionState::kOff);
  // Nothing moves again before a new order.
  rig.ticks(100);
  EXPECT_EQ(rig.session(), SessionState::kOff);
  rig.engage();
  EXPECT_EQ(rig.session(), SessionState::kEngaged);
}

TEST(HapticSession, AStopIsALatchedEpochThatOnlyAResetReleases) {
  HapticRig rig;
  rig.engage();
  EXPECT_EQ(rig.order(OrderKind::kStop), Reason::kNone);
  EXPECT_EQ(rig.session(), SessionState::kFault);
  EXPECT_EQ(rig.out.reason, Reason::kStopRequested);
  EXPECT_EQ(rig.out.link.stop_epoch, 1u);
  EXPECT_EQ(rig.out.link.released_epoch, 0u);
  for (const OrderKind kind : {OrderKind::kEngage, OrderKind::kTool, OrderKind::kClutchOn}) {
    EXPECT_NE(rig.order(kind), Reason::kNone);
    EXPECT_EQ(rig.out.link.released_epoch, 0u);
  }
  EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kStopRequested);
  EXPECT_EQ(rig.order(OrderKind::kReset), Reason::kNone);
  EXPECT_EQ(rig.out.link.released_epoch, 1u);
  EXPECT_EQ(rig.session(), SessionState::kOff);
  EXPECT_EQ(rig.order(OrderKind::kReset), Reason::kNotStopped);
}

TEST(HapticSession, AStopOnTopOfAnotherFaultIsTheReasonShown) {
  HapticRig rig;
  rig.engage();
  rig.in.slave_age = 300 * kMillisecond;
  rig.tick();
  rig.order(OrderKind::kStop);
  EXPECT_EQ(rig.out.reason, Reason::kStopRequested);
}

TEST(HapticSession, AStopAlsoLatchesWhenNothingIsEngagedOrConnected) {
  HapticRig rig;
  rig.in.slave_known = false;
  EXPECT_EQ(rig.order(OrderKind::kStop), Reason::kNone);
  EXPECT_EQ(rig.session(), SessionState::kFault);
}

TEST(HapticSession, RefusesToEngageWithTheReason) {
  const auto refusal = [](auto&& spoil) {
    HapticRig rig;
    spoil(rig);
    const Reason reason = rig.order(OrderKind::kEngage);
    // Refused is refused: the wish does not wait for the obstacle to go.
    rig.in.slave = HapticRig().in.slave;
    rig.in.slave_known = true;
    rig.in.slave_age = 0;
    rig.ticks(10);
    EXPECT_EQ(rig.session(), SessionState::kOff) << describe(reason);
    return reason;
  };
  EXPECT_EQ(refusal([](HapticRig& r) { r.in.slave_known = false; }), Reason::kNoPeer);
  EXPECT_EQ(refusal([](HapticRig& r) { r.in.slave_age = kSecond / 2; }), Reason::kNoPeer);
  EXPECT_EQ(refusal([](HapticRig& r) { r.in.slave_age = 2 * kSecond; }), Reason::kSessionClosed);
  EXPECT_EQ(refusal([](HapticRig& r) { r.in.slave.hashes.mapping = 1; }), Reason::kHashMapping);
  EXPECT_EQ(refusal([](HapticRig& r) { r.in.slave.hashes.limits = 1; }), Reason::kHashLimits);
  EXPECT_EQ(refusal([](HapticRig& r) { r.in.slave.hashes.robot = 1; }), Reason::kHashRobot);
  EXPECT_EQ(refusal([](HapticRig& r) { r.in.slave.scene = scene_name("other"); }),
            Reason::kSceneDiffers);
  EXPECT_EQ(refusal([](HapticRig& r) { r.in.slave.state = SessionState::kFault; }),
            Reason::kPeerFault);
}

TEST(HapticSession, AWishToEngageDoesNotOutliveALostLink) {
  HapticRig rig;
  rig.play_slave = false;  // never comes along
  rig.order(OrderKind::kEngage);
  rig.ticks(5);
  EXPECT_EQ(rig.session(), SessionState::kAligning);
  rig.in.slave_age = 3 * kSecond;
  rig.ticks(5);
  rig.in.slave_age = 0;
  rig.play_slave = true;
  rig.ticks(20);
  EXPECT_EQ(rig.session(), SessionState::kOff);
}

TEST(HapticSession, RefusesClutchAndToolsWhenNotEngaged) {
  HapticRig rig;
  EXPECT_EQ(rig.order(OrderKind::kClutchOn), Reason::kNotEngaged);
  EXPECT_EQ(rig.call(line_call(Vec3::UnitX())), Reason::kNotEngaged);
  EXPECT_EQ(rig.drop(true, true), Reason::kNoSuchTool);
  EXPECT_EQ(rig.order(OrderKind::kReset), Reason::kNotStopped);
  EXPECT_EQ(rig.order(OrderKind::kDisengage), Reason::kNone);
}

TEST(HapticSession, ARefusedToolChangesNothing) {
  HapticRig rig;
  rig.engage();
  ASSERT_EQ(rig.call(line_call(Vec3::UnitX(), true)), Reason::kNone);
  rig.ticks(10);
  const ToolDefinition before = rig.out.link.position_tool;
  const Pose command = rig.command();
  const double nan = std::nan("");
  ToolCall behind = line_call(Vec3::UnitX());
  behind.has_end = true;
  behind.p_SE = rig.command().p - Vec3(0.01, 0, 0);
  ToolCall bad_stiffness = line_call(Vec3::UnitX());
  bad_stiffness.stiffness = -1.0;
  const std::pair<ToolCall, Reason> refused[] = {
      {behind, Reason::kToolEndBehindStart},
      {line_call(Vec3::Zero()), Reason::kToolDirectionZero},
      {line_call({nan, 0, 0}), Reason::kToolValueInvalid},
      {line_call({1e300, 0, 0}), Reason::kToolValueInvalid},
      {test::plane_call(Vec3::Zero()), Reason::kToolDirectionZero},
      {bad_stiffness, Reason::kToolValueInvalid},
      {call_of(ToolKind::kNone), Reason::kNoSuchTool},
  };
  for (const auto& [call, reason] : refused) {
    EXPECT_EQ(rig.call(call), reason);
    EXPECT_EQ(hash_of(rig.out.link.position_tool), hash_of(before));
    EXPECT_EQ(rig.out.link.position_tool.epoch, before.epoch);
    EXPECT_EQ(rig.out.link.position_tool.id, before.id);
    EXPECT_TRUE(same_pose(rig.command(), command));
  }
  EXPECT_EQ(rig.drop(false, true), Reason::kNoSuchTool);
}

// A one-way line whose end lies behind the present command could only be obeyed by going back.
TEST(HapticSession, AOneWayLineThatWouldHaveToGoBackToItsEndIsRefused) {
  HapticRig rig;
  rig.engage();
  const Vec3 tip = rig.command().p;
  ToolCall line = test::at(line_call(Vec3::UnitX(), true), tip - Vec3(0.05, 0, 0));
  line.has_end = true;
  line.p_SE = tip - Vec3(0.01, 0, 0);
  EXPECT_EQ(rig.call(line), Reason::kToolEndBehindStart);
  line.one_way = false;
  EXPECT_EQ(rig.call(line), Reason::kNone);
}

TEST(HapticSession, Button2DropsTheToolsWhenItGoesDownAndNotWhileItStaysDown) {
  HapticRig rig;
  rig.engage();
  rig.call(line_call(Vec3::UnitX()));
  rig.call(call_of(ToolKind::kNRotation));
  rig.in.hand.drop_button = true;
  rig.tick();
  EXPECT_EQ(rig.out.link.position_tool.kind, ToolKind::kNone);
  EXPECT_EQ(rig.out.link.orientation_tool.kind, ToolKind::kNone);
  // Called while the button is still down: it stays.
  EXPECT_EQ(rig.call(call_of(ToolKind::kPoint)), Reason::kNone);
  rig.ticks(5);
  EXPECT_EQ(rig.out.link.position_tool.kind, ToolKind::kPoint);
  rig.in.hand.drop_button = false;
  rig.ticks(2);
  EXPECT_EQ(rig.out.link.position_tool.kind, ToolKind::kPoint);
}

TEST(HapticSession, OnePositionAndOneOrientationToolAreDroppedApart) {
  HapticRig rig;
  rig.engage();
  rig.call(line_call(Vec3::UnitX()));
  rig.call(call_of(ToolKind::kFRotation));
  EXPECT_EQ(rig.drop(true, false), Reason::kNone);
  EXPECT_EQ(rig.out.link.position_tool.kind, ToolKind::kNone);
  EXPECT_EQ(rig.out.link.orientation_tool.kind, ToolKind::kFRotation);
  EXPECT_EQ(rig.drop(false, true), Reason::kNone);
  EXPECT_EQ(rig.out.link.orientation_tool.kind, ToolKind::kNone);
}

TEST(HapticSession, ToolEpochsRiseByOneAtEveryChangeAndTheHashNamesBoth) {
  HapticRig rig;
  rig.engage();
  const std::uint64_t none = rig.out.link.hashes.tools;
  rig.call(call_of(ToolKind::kPoint));
  EXPECT_EQ(rig.out.link.position_tool.epoch, 1u);
  const std::uint64_t point = rig.out.link.hashes.tools;
  EXPECT_NE(point, none);
  rig.call(call_of(ToolKind::kNRotation));
  EXPECT_EQ(rig.out.link.position_tool.epoch, 1u);
  EXPECT_EQ(rig.out.link.orientation_tool.epoch, 1u);
  EXPECT_NE(rig.out.link.hashes.tools, point);
  rig.drop(true, true);
  EXPECT_EQ(rig.out.link.position_tool.epoch, 2u);
  EXPECT_EQ(rig.out.link.orientation_tool.epoch, 2u);
}

TEST(HapticSession, AFaultAndADisengagementDropTheTools) {
  for (const OrderKind kind : {OrderKind::kStop, OrderKind::kDisengage}) {
    HapticRig rig;
    rig.engage();
    rig.call(line_call(Vec3::UnitX()));
    rig.order(kind);
    EXPECT_EQ(rig.out.link.position_tool.kind, ToolKind::kNone);
  }
}

TEST(HapticSession, ARestartedSlaveIsNotFollowedIntoAJump) {
  HapticRig rig;
  rig.engage();
  rig.play_slave = false;
  rig.in.slave.state = SessionState::kOff;
  rig.tick();
  EXPECT_EQ(rig.session(), SessionState::kFault);
  EXPECT_EQ(rig.out.reason, Reason::kSessionClosed);
}

}  // namespace
}  // namespace handrail
