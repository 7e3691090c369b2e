// Time at the robot that the slave did not see.
#include "server/slave/robot_loop.h"

#include <gtest/gtest.h>

#include "tests/unit/slave/robot_loop_rig.h"

namespace handrail {
namespace {

using test::kPeriod;
using test::now_value;
using test::RobotLoopTest;

TEST_F(RobotLoopTest, CyclesWithoutAReplyAreCountedAndDoNotHaltASlowArm) {
  engage();
  news.state.X_SU.p.z() += 0.01;
  turn();
  const int sends = robot.sends;
  robot.script = {RobotEvent::kSilence, RobotEvent::kSilence};
  turn();
  turn();
  EXPECT_EQ(robot.sends, sends + 2);
  EXPECT_EQ(robot.asks, 0);
  EXPECT_EQ(state.silences, 2u);
}

TEST_F(RobotLoopTest, AnArmThatIsNotHeardIsHaltedAskedForAndGoesOnFromRest) {
  engage();
  news.state.X_SU.p.z() -= 0.1;
  for (int i = 0; i < 20; ++i) turn();
  const double speed = robot.largest_step;
  robot.deaf = true;
  robot.script.assign(60, RobotEvent::kSilence);
  for (int i = 0; i < 60; ++i) turn();
  EXPECT_EQ(state.reason, Reason::kRobotSilent);
  EXPECT_GT(robot.asks, 0);
  robot.deaf = false;
  const JointVector held = robot.q;
  robot.largest_step = 0.0;
  for (int i = 0; i < 4; ++i) turn();
  EXPECT_LT(robot.largest_step, 0.5 * speed) << "from rest, from where the controller holds it";
  EXPECT_NE(robot.q, held);
  for (int i = 0; i < 300; ++i) turn();
  EXPECT_NEAR(state.X_ST_command.p.z(), news.state.X_SU.p.z(), 1e-6);
}

TEST_F(RobotLoopTest, APausedSlaveGoesOnFromRestAndIsNotEngagedAfterALongPause) {
  engage();
  news.state.X_SU.p.z() += 0.2;
  for (int i = 0; i < 30; ++i) turn();
  const double speed = robot.largest_step;
  robot.largest_step = 0.0;
  robot.cycles = 700;
  now_value += 700 * kPeriod;
  turn();
  robot.cycles = 1;
  EXPECT_EQ(state.state, SessionState::kFault);
  EXPECT_EQ(state.fault, Reason::kLinkLost);
  for (int i = 0; i < 50; ++i) turn();
  EXPECT_LT(robot.largest_step, 1e-6 * speed) << "nobody has engaged";
}

TEST_F(RobotLoopTest, RefusesAnArmThatAnswersZerosOrIsNotWhereItIsCommanded) {
  const JointVector sound = robot.q;
  robot.q.setZero();  // J3 begins at 50 deg
  const Nanos start = now_value;
  while (now_value < start + 3 * kSecond) turn(false);
  EXPECT_GE(robot.connects, 2);
  EXPECT_FALSE(loop.connected());
  robot.q = sound;
  robot.measured = sound;
  (*robot.measured)[1] += 0.05;
  while (now_value < start + 6 * kSecond) turn(false);
  EXPECT_FALSE(loop.connected());
  EXPECT_EQ(robot.sends, 0);
  robot.measured.reset();
  while (now_value < start + 9 * kSecond) turn(false);
  EXPECT_TRUE(loop.connected());
}

TEST_F(RobotLoopTest, ALostRobotThatDoesNotAnswerAResetIsLostAnew) {
  engage();
  robot.script = {RobotEvent::kLost};
  turn();
  robot.present = false;
  news.state.desired = Desired::kOff;
  news.state.state = SessionState::kOff;
  const std::uint64_t fault = state.fault_epoch;
  news.state.fault_reset = fault;
  for (int i = 0; i < 300; ++i) turn();
  EXPECT_EQ(state.fault, Reason::kRobotLost);
  EXPECT_EQ(state.fault_epoch, fault + 1);
  const int connects = robot.connects;
  robot.present = true;
  for (int i = 0; i < 300; ++i) turn();
  EXPECT_EQ(robot.connects, connects) << "it waits for another reset";
}

}  // namespace
}  // namespace handrail
