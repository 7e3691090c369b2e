// The robot thread's work.
#include "server/slave/robot_loop.h"

#include <gtest/gtest.h>

#include "tests/unit/slave/robot_loop_rig.h"

namespace handrail {
namespace {

using test::kPeriod;
using test::manual_now;
using test::now_value;
using test::RobotLoopTest;
using test::settings;

TEST_F(RobotLoopTest, WhatItSaysStandsForARoundAndThroughTheWaitForAController) {
  turn();
  turn();
  EXPECT_EQ(report.good_until, now_value + kStateStands);
  robot.present = false;
  robot.script.push_back(RobotEvent::kLost);
  turn();
  news.state.fault_reset = state.fault_epoch;
  boxes.master.publish(news);
  const Nanos asked = now_value;
  loop.turn();
  ASSERT_TRUE(boxes.report.take(report));
  EXPECT_EQ(now_value, asked + RobotLoop::kConnectPatience + kPeriod) << "it waited";
  EXPECT_EQ(report.good_until, now_value + kStateStands);
}

TEST_F(RobotLoopTest, SaysThatNoRobotIsConnectedAndTriesEverySecond) {
  robot.present = false;
  const Nanos start = now_value;
  while (now_value < start + 10 * kSecond) turn(false);
  EXPECT_EQ(state.reason, Reason::kRobotNotConnected);
  EXPECT_FALSE(state.has_pose);
  EXPECT_EQ(state.cycles, 0u);
  EXPECT_GE(robot.connects, 8);
  EXPECT_LE(robot.connects, 10);
  robot.present = true;
  while (now_value < start + 12 * kSecond && !loop.connected()) turn(false);
  EXPECT_TRUE(loop.connected());
}

TEST_F(RobotLoopTest, SaysWhichJointOfAnArmThatAnswersKeepsItFromConnecting) {
  const JointVector sound = robot.q;
  const auto said = [&](int joint, double q) {
    return state.reason == Reason::kEncoderInvalid && state.obstacle == Reason::kEncoderInvalid &&
           state.ledger.joint == joint && state.q_measured[joint] == q;
  };
  robot.q.setZero();  // J3 begins at 50 deg
  for (int i = 0; i < 1000; ++i) {
    turn();
    ASSERT_TRUE(i == 0 || said(2, 0.0)) << i << ": " << describe(state.reason);
  }
  EXPECT_EQ(state.state, SessionState::kOff);
  EXPECT_GE(robot.connects, 6) << "it tries again";
  // An arm that stands beside its target.
  robot.q = sound;
  robot.measured = sound;
  (*robot.measured)[1] += 0.05;
  for (int i = 0; i < 300; ++i) turn();
  EXPECT_TRUE(said(1, (*robot.measured)[1])) << describe(state.reason);
  // One that answers nothing is not connected, whatever it said before.
  robot.present = false;
  for (int i = 0; i < 300; ++i) turn();
  EXPECT_EQ(state.reason, Reason::kRobotNotConnected);
  EXPECT_EQ(state.obstacle, Reason::kNone);
  EXPECT_EQ(state.ledger.joint, -1);
  robot.present = true;
  robot.measured.reset();
  for (int i = 0; i < 300; ++i) turn();
  EXPECT_TRUE(loop.connected());
  EXPECT_EQ(state.reason, Reason::kNotEngaged);
  EXPECT_EQ(state.obstacle, Reason::kNone);
  EXPECT_EQ(state.ledger.joint, -1);
}

TEST_F(RobotLoopTest, AResetThatMeetsAnArmThatAnswersZerosSaysSo) {
  engage();
  robot.script = {RobotEvent::kLost};
  turn();
  robot.q.setZero();
  news.state.desired = Desired::kOff;
  news.state.state = SessionState::kOff;
  news.state.fault_reset = state.fault_epoch;
  for (int i = 0; i < 5; ++i) turn();
  EXPECT_EQ(state.state, SessionState::kFault);
  EXPECT_EQ(state.fault, Reason::kEncoderInvalid);
  EXPECT_EQ(state.ledger.joint, 2);
  EXPECT_EQ(state.q_measured[2], 0.0);
}

TEST_F(RobotLoopTest, AResetOfAStopWithoutARobotNamesTheRobot) {
  robot.present = false;
  for (int i = 0; i < 5; ++i) turn();
  news.state.stop_epoch = 1;
  for (int i = 0; i < 5; ++i) turn();
  EXPECT_EQ(state.fault, Reason::kStopRequested);
  news.state.released_epoch = 1;
  news.state.fault_reset = state.fault_epoch;
  for (int i = 0; i < 5; ++i) turn();
  EXPECT_EQ(state.state, SessionState::kFault);
  EXPECT_EQ(state.fault, Reason::kRobotNotConnected);
  EXPECT_EQ(state.fault_epoch, news.state.fault_reset + 1);
  robot.present = true;
  for (int i = 0; i < 1000 && !loop.connected(); ++i) turn();
  news.state.fault_reset = state.fault_epoch;
  for (int i = 0; i < 5; ++i) turn();
  EXPECT_EQ(state.state, SessionState::kOff);
}

TEST_F(RobotLoopTest, ConnectingMovesNothing) {
  const JointVector before = robot.q;
  for (int i = 0; i < 50; ++i) turn(false);
  EXPECT_EQ(robot.q, before);
  EXPECT_EQ(robot.sends, 50);  // the first on connecting, then one a reply
  EXPECT_TRUE(state.has_pose);
  EXPECT_EQ(state.cycles, 49u);
}

TEST_F(RobotLoopTest, AnswersEveryReplyOnceAndFollowsTheMaster) {
  engage();
  const double before = state.X_ST_command.p.z();
  news.state.X_SU.p.z() += 0.01;
  const int sends = robot.sends;
  for (int i = 0; i < 100; ++i) turn();
  EXPECT_EQ(robot.sends, sends + 100);
  EXPECT_NEAR(state.X_ST_command.p.z(), before + 0.01, 1e-9);
  EXPECT_GT(robot.largest_step, 0.0);
}

TEST_F(RobotLoopTest, AnOpenStopCircuitLatchesAFaultThatNoResetTakesAwayWhileItIsOpen) {
  engage();
  circuit.open = true;
  turn();
  turn();
  EXPECT_EQ(state.state, SessionState::kFault);
  EXPECT_EQ(state.fault, Reason::kStopInput);
  const auto reset = [&] {
    news.state.desired = Desired::kOff;
    news.state.state = SessionState::kOff;
    news.state.fault_reset = state.fault_epoch;
    for (int i = 0; i < 5; ++i) turn();
  };
  reset();
  EXPECT_EQ(state.fault, Reason::kStopInput);
  circuit.open = false;
  turn();
  EXPECT_EQ(state.state, SessionState::kFault) << "closing it alone moves nothing";
  reset();
  EXPECT_EQ(state.state, SessionState::kOff);
}

TEST_F(RobotLoopTest, AnOldCommandIsNotFollowed) {
  engage();
  news.state.X_SU.p.z() += 0.05;
  for (int i = 0; i < 4; ++i) turn(false);
  EXPECT_EQ(state.state, SessionState::kHold);
  EXPECT_EQ(state.reason, Reason::kLinkHold);
}

TEST_F(RobotLoopTest, ALostRobotLatchesAFaultAndIsCalledAgainOnlyAfterReset) {
  engage();
  robot.script = {RobotEvent::kLost};
  turn();
  EXPECT_EQ(state.state, SessionState::kFault);
  EXPECT_EQ(state.fault, Reason::kRobotLost);
  EXPECT_FALSE(state.has_pose);
  const int connects = robot.connects;
  for (int i = 0; i < 1000; ++i) turn();
  EXPECT_EQ(robot.connects, connects);
  EXPECT_EQ(state.state, SessionState::kFault);

  news.state.desired = Desired::kOff;
  news.state.state = SessionState::kOff;
  news.state.fault_reset = state.fault_epoch;
  for (int i = 0; i < 5; ++i) turn();
  EXPECT_EQ(robot.connects, connects + 1);
  EXPECT_EQ(state.state, SessionState::kOff);
  EXPECT_TRUE(state.has_pose);
}

TEST_F(RobotLoopTest, WhatMayBeAnotherControllerIsAskedFirst) {
  engage();
  turn();
  const int asks = robot.asks, sends = robot.sends;
  robot.anew = true;
  turn();
  EXPECT_EQ(robot.asks, asks + 1);
  EXPECT_EQ(robot.sends, sends);
  robot.anew = false;
  for (int i = 0; i < 3; ++i) turn();
  EXPECT_GT(robot.sends, sends);
}

TEST_F(RobotLoopTest, TwoStartsOfASlaveHaveNoFaultInCommon) {
  turn();
  const std::uint64_t first = state.fault_epoch;
  RobotLoop second(robot, settings(), boxes, manual_now);
  (void)second.turn();
  ASSERT_TRUE(boxes.report.take(report));
  constexpr std::uint64_t kLifetime = 1ULL << 40;
  EXPECT_GT(report.state.fault_epoch - first, kLifetime);
  EXPECT_GT(first - report.state.fault_epoch, kLifetime);
}

TEST_F(RobotLoopTest, RingsOnceWhenItHasAnotherStop) {
  engage();
  EXPECT_FALSE(boxes.doorbell.answer());
  news.state.stop_epoch = 1;
  turn();
  EXPECT_EQ(state.stop_epoch, 1u);
  EXPECT_TRUE(boxes.doorbell.answer());
  for (int i = 0; i < 10; ++i) turn();
  EXPECT_FALSE(boxes.doorbell.answer());
}

TEST_F(RobotLoopTest, AStandingStopKeepsALostRobotAway) {
  engage();
  robot.script = {RobotEvent::kLost};
  turn();
  news.state.stop_epoch = 1;
  for (int i = 0; i < 10; ++i) turn();
  EXPECT_EQ(state.fault, Reason::kStopRequested);
  const int connects = robot.connects;
  news.state.fault_reset = state.fault_epoch;
  for (int i = 0; i < 300; ++i) turn();
  EXPECT_EQ(robot.connects, connects);
  news.state.released_epoch = 1;
  for (int i = 0; i < 10; ++i) turn();
  EXPECT_EQ(robot.connects, connects + 1);
}

TEST_F(RobotLoopTest, AsksToEndOnceTheArmStands) {
  engage();
  news.state.X_SU.p.z() += 0.05;
  for (int i = 0; i < 10; ++i) turn();
  const JointVector moving = robot.q;
  loop.request_stop();
  int turns = 0;
  while (!loop.finished() && turns < 100) {
    turn();
    ++turns;
  }
  EXPECT_TRUE(loop.finished());
  EXPECT_EQ(robot.ends, 1);
  EXPECT_GT(turns, 1);  // it took some cycles to slow down
  EXPECT_NE(robot.q, moving);
}

TEST_F(RobotLoopTest, EndsEvenWhenTheControllerHasFallenSilent) {
  engage();
  robot.script.assign(1000, RobotEvent::kSilence);
  loop.request_stop();
  const Nanos asked = now_value;
  while (!loop.finished() && now_value < asked + 10 * kSecond) turn();
  EXPECT_TRUE(loop.finished());
  EXPECT_LE(now_value - asked, RobotLoop::kStopPatience + 3 * kPeriod);
}

TEST_F(RobotLoopTest, EndsAtOnceWithoutARobot) {
  robot.present = false;
  turn(false);
  loop.request_stop();
  loop.turn();
  EXPECT_TRUE(loop.finished());
}

TEST_F(RobotLoopTest, AnotherSceneWaitsUntilTheArmIsLetGo) {
  engage();
  FollowSettings second = settings();
  second.scene = scene_name("second");
  boxes.settings.publish(second);
  for (int i = 0; i < 10; ++i) turn();
  EXPECT_EQ(text_of(state.scene), "first");
  news.state.desired = Desired::kOff;
  news.state.state = SessionState::kOff;
  for (int i = 0; i < 3; ++i) turn();
  EXPECT_EQ(text_of(state.scene), "second");
}

TEST_F(RobotLoopTest, AMasterWithoutOurSceneIsNotFollowed) {
  news.state.scene = SceneName();
  news.link.peer_epoch = 1;
  turn();
  news.state.desired = Desired::kEngaged;
  news.state.state = SessionState::kAligning;
  news.state.X_SU = turn().X_ST_command;
  news.state.has_command = true;
  for (int i = 0; i < 10; ++i) EXPECT_EQ(turn().state, SessionState::kOff);
  EXPECT_EQ(state.reason, Reason::kSceneDiffers);
}

TEST_F(RobotLoopTest, ARestartedMasterEndsTheSession) {
  engage();
  news.link.peer_epoch = 2;
  news.state = MasterState();
  news.state.desired = Desired::kEngaged;
  news.state.state = SessionState::kEngaged;
  news.state.engagement_epoch = 99;
  turn();
  EXPECT_EQ(state.state, SessionState::kOff);
  EXPECT_EQ(state.reason, Reason::kSessionClosed);
}

TEST_F(RobotLoopTest, OldOrFaultyForcesCountAsMissing) {
  const auto wrench_known = [&](bool healthy, Nanos age) {
    ForceReading reading;
    reading.f_E_T.force.z() = 5.0;
    reading.healthy = healthy;
    turn_with(reading, age);
    return state.has_wrench;
  };
  turn();
  EXPECT_TRUE(wrench_known(true, 0));
  EXPECT_NEAR(state.f_E_S.force.norm(), 5.0, 1e-12);
  EXPECT_FALSE(wrench_known(false, 0));
  EXPECT_TRUE(wrench_known(true, RobotLoop::kForceFresh));
  EXPECT_FALSE(wrench_known(true, RobotLoop::kForceFresh + 1));
}

TEST_F(RobotLoopTest, AForceBeyondTheRangeIsToldAsSuchWhileItIsNew) {
  FollowSettings needing = settings();
  needing.sensor_required = true;
  boxes.settings.publish(needing);
  const auto told = [&](Nanos age) {
    ForceReading reading;
    reading.overrange = true;
    turn_with(reading, age);
    return state.obstacle;
  };
  turn();
  EXPECT_EQ(told(RobotLoop::kForceFresh), Reason::kSensorOverrange);
  EXPECT_EQ(told(RobotLoop::kForceFresh + 1), Reason::kSensorMissing);
}

TEST_F(RobotLoopTest, DoesNotAllocateWhileConnected) {
  engage();
  test::NoAllocation guard("the robot loop");
  for (int i = 0; i < 100; ++i) turn();
}

}  // namespace
}  // namespace handrail
