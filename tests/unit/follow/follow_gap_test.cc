// Time that the slave did not see: which targets it may send, when the arm is halted, how it goes
// on.
#include "server/follow/follow_gap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/unit/follow/follow_rig.h"

namespace handrail {
namespace {

using test::FollowRig;
using test::home;

JointVector all(double q) { return JointVector::Constant(q); }

TEST(CommandTrain, OnlyWhatIsInAStepOfAllThatMayBeHeldMayBeSent) {
  CommandTrain train;
  const JointVector step = all(1.0);
  train.restart(all(0.0));
  EXPECT_TRUE(train.may_send(all(1.0), step));
  EXPECT_FALSE(train.may_send(all(1.01), step));
  train.add(all(0.6));
  EXPECT_FALSE(train.may_send(all(1.2), step)) << "the controller may still hold 0";
  EXPECT_FALSE(train.may_send(all(-0.5), step)) << "or already 0.6";
  EXPECT_TRUE(train.confirm(all(0.6), step));
  EXPECT_TRUE(train.may_send(all(1.2), step));
}

TEST(CommandTrain, AnOlderAnswerTakesNothingBack) {
  CommandTrain train;
  const JointVector step = all(1.0);
  train.restart(all(0.0));
  train.add(all(0.5));
  train.add(all(0.9));
  EXPECT_TRUE(train.confirm(all(0.5), step));
  EXPECT_EQ(train.unconfirmed(), 1u);
  EXPECT_TRUE(train.confirm(all(0.0), step)) << "late; what it said before stands";
  EXPECT_EQ(train.confirmed(), all(0.5));
}

TEST(CommandTrain, AControllerThatHoldsSomethingElseIsFound) {
  CommandTrain train;
  train.restart(all(0.0));
  train.add(all(0.1));
  EXPECT_FALSE(train.confirm(all(1.5), all(1.0)));
  EXPECT_EQ(train.unconfirmed(), 1u);
}

TEST(CommandTrain, TellsWhatIsRoundedToThirtyTwoBitsApart) {
  CommandTrain train;
  const double q = 1.0 / 3.0;
  train.restart(all(q));
  train.add(all(q + 1e-5));
  EXPECT_TRUE(train.confirm(all(static_cast<float>(q)), all(0.01)));
  EXPECT_EQ(train.unconfirmed(), 1u);
  EXPECT_TRUE(train.confirm(all(static_cast<float>(q + 1e-5)), all(0.01)));
  EXPECT_EQ(train.unconfirmed(), 0u);
}

TEST(CommandTrain, IsNeverFullerThanItIsLong) {
  CommandTrain train;
  train.restart(all(0.0));
  int sent = 0;
  for (int i = 1; i < 200; ++i) {
    const JointVector q = all(1e-3 * i);
    if (!train.may_send(q, all(1.0))) break;
    train.add(q);
    ++sent;
  }
  EXPECT_EQ(sent, 14);
  EXPECT_TRUE(train.may_send(train.newest(), all(1.0)));
}

// An engaged arm that is led away from home, with a controller that says what it holds.
class FollowGap : public ::testing::Test {
 protected:
  FollowGap() {
    rig.engage();
    target = rig.state.motion.X_ST;
    target.p.z() += 0.3;
  }

  // One cycle; `heard`: the controller took the target and said so.
  void cycle(bool heard = true) {
    rig.in.answer = heard ? Answer::kOnTime : Answer::kNone;
    rig.in.master.X_SU = target;
    rig.in.master_age = 0;
    rig.in.q_measured = rig.in.q_commanded = held;
    follow_step(rig.settings, rig.in, rig.state, rig.out);
    step = (rig.out.q_target - held).cwiseAbs().maxCoeff();
    if (heard && rig.out.send == Send::kTarget) held = rig.out.q_target;
  }
  void cycles(int count, bool heard = true) {
    for (int i = 0; i < count; ++i) cycle(heard);
  }

  FollowRig rig;
  Pose target;
  JointVector held = rig.joints();
  double step = 0.0;  // of the newest target, from where the controller holds the arm [rad]
};

TEST_F(FollowGap, AnAnswerThatDoesNotSayWhatIsHeldConfirmsNothing) {
  cycles(4);
  ASSERT_EQ(rig.state.train.unconfirmed(), 1u);
  rig.in.has_commanded = false;
  cycles(2);
  EXPECT_EQ(rig.state.train.unconfirmed(), 3u);
}

TEST_F(FollowGap, AnAnswerWithoutMeasuredJointsIsNotTakenForTheArm) {
  cycles(4);
  rig.in.has_measured = false;
  rig.in.q_commanded = held;
  rig.in.q_measured.setConstant(std::nan(""));
  for (int i = 0; i < 5; ++i) {
    follow_step(rig.settings, rig.in, rig.state, rig.out);
    rig.in.q_commanded = rig.out.q_target;
  }
  EXPECT_EQ(rig.state.fault, Reason::kNone);
  EXPECT_TRUE(rig.out.link.q_measured.allFinite());
}

TEST_F(FollowGap, AnArmInMotionIsHaltedWhereTheNextTargetIsBeyondARatedStep) {
  cycles(12);
  const double rated = rated_step(rig.settings).minCoeff();
  ASSERT_GT(step, 0.05 * rated);
  int sent = 0;
  for (; sent < 64; ++sent) {
    cycle(false);
    if (rig.out.send != Send::kTarget) break;
    ASSERT_TRUE(
        ((rig.out.q_target - held).cwiseAbs().array() <= rated_step(rig.settings).array()).all());
  }
  EXPECT_GT(sent, 0);
  EXPECT_LT(sent, 20);
  EXPECT_TRUE(rig.state.gap);
  EXPECT_EQ(rig.state.halts, 1u);
  EXPECT_EQ(rig.out.send, Send::kQuestion);
  EXPECT_EQ(rig.out.link.reason, Reason::kRobotSilent);
}

TEST_F(FollowGap, SaysNothingOfAMotionWhereTheArmStood) {
  rig.in.anew = true;
  cycle(false);
  ASSERT_TRUE(rig.state.gap);
  EXPECT_FALSE(rig.state.halted);
  const std::string why = describe(rig.out.link.reason);
  EXPECT_EQ(rig.out.link.reason, Reason::kRobotSilent);
  EXPECT_EQ(why.find("motion"), std::string::npos) << why;
  EXPECT_EQ(why.find("halted"), std::string::npos) << why;
}

TEST_F(FollowGap, GoesOnFromRestFromWhereTheControllerHoldsTheArm) {
  cycles(60);
  cycles(40, false);
  ASSERT_TRUE(rig.state.gap);
  double fastest = 0.0, change = 0.0, last = 0.0;
  const double dt = rig.settings.motion->dt;
  for (int i = 0; i < 30; ++i) {
    const JointVector before = held;
    cycle();
    const double moved = (held - before).cwiseAbs().maxCoeff();
    change = std::max(change, std::abs(moved - last));
    fastest = std::max(fastest, last = moved);
  }
  EXPECT_FALSE(rig.state.gap);
  EXPECT_GT(fastest, 0.0);
  EXPECT_LE(change, rig.settings.motion->limits.max_acceleration.maxCoeff() * dt * dt);
}

// So slowly that all of half a second is within a rated step.
TEST_F(FollowGap, ASlowArmThatHasStoodForATenthOfASecondIsNotSentTheNextTarget) {
  rig.in.master_age = 0;
  for (int i = 0; i < 100; ++i) {
    target.p.z() = rig.state.motion.X_ST.p.z() + 2e-4;
    cycle();
  }
  int sent = 0;
  for (int i = 0; i < 50; ++i) {
    target.p.z() = rig.state.motion.X_ST.p.z() + 2e-4;
    cycle(false);
    sent += rig.out.send == Send::kTarget;
  }
  EXPECT_TRUE(rig.state.gap);
  EXPECT_LE(sent * rig.settings.motion->dt, 0.1);
  EXPECT_EQ(rig.state.session, SessionState::kEngaged);
  cycles(5);
  EXPECT_EQ(rig.state.fault, Reason::kNone);
}

// Another controller, or somebody moved the arm: it does not drive back by itself.
TEST_F(FollowGap, AControllerThatComesBackWithTheArmElsewhereIsAFaultOfThatJoint) {
  cycles(60);
  cycles(40, false);
  ASSERT_TRUE(rig.state.gap);
  held[2] += 0.09;
  const JointVector there = held;
  cycles(20);
  EXPECT_EQ(rig.state.session, SessionState::kFault);
  EXPECT_EQ(rig.state.fault, Reason::kEncoderInvalid);
  EXPECT_EQ(rig.out.link.ledger.joint, 2);
  cycles(100);
  EXPECT_EQ(held, there);
  rig.in.master.fault_reset = rig.state.fault_epoch;
  rig.in.master.desired = Desired::kOff;
  cycles(2);
  EXPECT_EQ(rig.state.session, SessionState::kOff) << "a reset is enough";
}

// A controller that starts anew holds its arm where that is, not where it was last sent.
TEST_F(FollowGap, AControllerThatStartedAnewIsNotSentAStepToWhereTheArmWas) {
  for (int i = 0; i < 400; ++i) cycle();
  ASSERT_TRUE(standing(rig.state.motion));
  cycles(14, false);
  held = held.array() + 0.3 * rig.settings.rated.max_speed[4] * rig.settings.motion->dt;
  const double most =
      1.01 * rig.settings.rated.max_jerk.maxCoeff() * std::pow(rig.settings.motion->dt, 3);
  for (int i = 0; i < 20; ++i) {
    const JointVector before = held;
    rig.in.anew = i == 0;
    cycle();
    EXPECT_LE((held - before).cwiseAbs().maxCoeff(), most * (i + 1)) << i;
  }
  EXPECT_EQ(rig.out.link.state, SessionState::kEngaged);
}

TEST_F(FollowGap, AStopDuringTheSilenceStands) {
  cycles(60);
  cycles(10, false);
  rig.in.master.stop_epoch = 1;
  cycles(10, false);
  EXPECT_EQ(rig.state.session, SessionState::kFault);
  const JointVector before = held;
  cycles(50);
  EXPECT_EQ(held, before);
  EXPECT_EQ(rig.state.fault, Reason::kStopRequested);
}

// The whole stop is within a rated step of what the controller holds: nothing halts it.
TEST_F(FollowGap, AnEndThatNobodyHeardOfIsNotSentToAnArmThatHasStood) {
  cycles(4);
  rig.in.master.stop_epoch = 1;
  cycles(40, false);
  ASSERT_TRUE(standing(rig.state.motion));
  EXPECT_EQ(rig.state.halts, 0u);
  ASSERT_NE(rig.state.motion.joints.q, held);
  const JointVector before = held;
  cycles(40);
  EXPECT_EQ(held, before);
  EXPECT_EQ(rig.state.motion.joints.q, held);
  EXPECT_EQ(rig.state.halts, 1u) << "where it is known that the arm did not get there";
}

TEST_F(FollowGap, AnEndThatIsNotSentAnyMoreHaltsTheArm) {
  while (step == 0.0) cycle();
  rig.in.stop_input = true;
  rig.in.cycles = 4;
  cycle(false);
  ASSERT_TRUE(rig.state.gap && standing(rig.state.motion));
  EXPECT_NE(rig.out.send, Send::kTarget);
  EXPECT_EQ(rig.state.halts, 1u);
}

TEST_F(FollowGap, APauseLongerThanAFewCyclesIsAGap) {
  cycles(60);
  rig.in.cycles = 5;
  cycle();
  EXPECT_TRUE(rig.state.gap);
  EXPECT_EQ(rig.out.send, Send::kQuestion);
  rig.in.cycles = 1;
  cycle();
  EXPECT_FALSE(rig.state.gap);
}

TEST_F(FollowGap, AShortPauseIsPlannedThroughWhereAStepAllowsIt) {
  cycles(6);
  const double before = step;
  rig.in.cycles = 2;
  cycle();
  EXPECT_FALSE(rig.state.gap);
  EXPECT_GT(step, 1.5 * before) << "two cycles' way";
}

TEST_F(FollowGap, AStandingArmSetsOutWithOneCyclesStepHoweverManyHavePassed) {
  const FollowState before = rig.state;
  const JointVector q = held;
  cycle();
  const double one = step;
  ASSERT_GT(one, 0.0);
  rig.state = before;
  held = q;
  rig.in.cycles = 3;
  cycle();
  EXPECT_EQ(step, one);
}

TEST_F(FollowGap, WhatTheMasterSaidIsAsOldAsThePause) {
  cycles(10);
  rig.in.unseen = kSecond;
  cycle();
  EXPECT_EQ(rig.state.session, SessionState::kFault);
  EXPECT_EQ(rig.state.fault, Reason::kLinkLost);
}

TEST_F(FollowGap, AControllerThatQueuesIsLeftToWorkOff) {
  cycles(8);
  // It takes one of the targets a cycle later than it is sent.
  JointVector queued = held;
  int left_out = 0;
  for (int i = 0; i < 6; ++i) {
    const JointVector next = queued;
    rig.in.answer = Answer::kOnTime;
    rig.in.q_measured = rig.in.q_commanded = held;
    follow_step(rig.settings, rig.in, rig.state, rig.out);
    held = next;
    if (rig.out.send == Send::kTarget) queued = rig.out.q_target;
    left_out += rig.out.send == Send::kNothing;
  }
  EXPECT_GE(left_out, 1);
  EXPECT_EQ(rig.state.halts, 0u);
}

// The controller takes every target, but its answers come a cycle late: after the cycle's, or with
// silent cycles between. Without a target in every cycle it would hold a moving arm.
TEST_F(FollowGap, AnswersThatAreLateShowNoQueue) {
  target.p.z() -= 0.288;  // slow enough for two targets of which nobody knows
  cycles(8);
  const FollowState start = rig.state;
  const JointVector first = held;
  for (const Answer between : {Answer::kLate, Answer::kNone}) {
    rig.state = start;
    JointVector before = held = first;
    for (int i = 0; i < 12; ++i) {
      // Three in a row that look in time, as chance would have it.
      rig.in.answer = i % 4 == 3 ? between : Answer::kOnTime;
      rig.in.q_measured = rig.in.q_commanded = before;
      before = held;
      follow_step(rig.settings, rig.in, rig.state, rig.out);
      ASSERT_EQ(rig.out.send, Send::kTarget) << i;
      held = rig.out.q_target;
    }
  }
}

// A fast arm; a target comes just after its cycle, so the next one would be two steps, and the arm
// is halted. The answer after that has the late target: a step from rest, sent at once, would
// follow a step at full speed.
TEST_F(FollowGap, AHaltedArmIsHeldForACycleBeforeItSetsOut) {
  target = rig.state.motion.X_ST;
  target.p.y() += 0.5;
  for (int i = 0; i < 60 && step < 0.6 * rated_step(rig.settings)[0]; ++i) cycle();
  ASSERT_GE(step, 0.6 * rated_step(rig.settings)[0]);
  const auto answers = [&](const JointVector& q) {
    rig.in.answer = Answer::kOnTime;
    rig.in.q_measured = rig.in.q_commanded = q;
    follow_step(rig.settings, rig.in, rig.state, rig.out);
    return rig.out.send;
  };
  const JointVector before = held;
  ASSERT_EQ(answers(before), Send::kTarget);
  const JointVector late = rig.out.q_target;
  ASSERT_EQ(answers(before), Send::kQuestion);
  ASSERT_EQ(rig.state.halts, 1u);
  EXPECT_EQ(answers(late), Send::kQuestion) << "taken just now";
  EXPECT_EQ(answers(late), Send::kTarget);
  EXPECT_LT((rig.out.q_target - late).cwiseAbs().maxCoeff(), 0.1 * step);
}

TEST_F(FollowGap, AMasterInHoldLeadsNobody) {
  cycles(60);
  rig.in.master.state = SessionState::kHold;
  for (int i = 0; i < 60; ++i) {
    target.p.z() += 1e-3;
    cycle();
  }
  EXPECT_TRUE(standing(rig.state.motion));
  EXPECT_EQ(rig.out.link.reason, Reason::kLinkHold);
  EXPECT_EQ(rig.state.session, SessionState::kEngaged) << "and goes on with it";
}

TEST_F(FollowGap, AnArmThatReadsBeyondItsRangeIsAFaultOfThatJoint) {
  cycles(10);
  held[4] = rig.settings.rated.upper[4] + 0.05;
  cycles(5);
  EXPECT_EQ(rig.state.fault, Reason::kEncoderInvalid);
  EXPECT_EQ(rig.out.link.ledger.joint, 4);
}

}  // namespace
}  // namespace handrail
