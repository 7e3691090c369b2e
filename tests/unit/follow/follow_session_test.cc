// Following, holding, stopping and latching, seen from outside the slave's step.
#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/constraint/tool_samples.h"
#include "tests/unit/follow/follow_rig.h"

namespace handrail {
namespace {

using test::Dice;
using test::FollowRig;

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
// A stop that no tool holds keeps its way but for what is of third order: 2.6 um from 0.2 m/s [m].
constexpr double kBesideItsWay = 5e-6;

// Engaged and on the way at 0.2 m/s, in +Y.
void set_going(FollowRig& rig) {
  rig.engage();
  Pose X = rig.state.motion.X_ST;
  for (int i = 0; i < 30; ++i) {
    X.p.y() += 0.2 * rig.settings.motion->dt;
    rig.follow(X);
  }
}

TEST(FollowSession, MovesNothingBeforeTheFirstValidCommand) {
  FollowRig rig;
  const JointVector start = rig.joints();
  Dice dice(1);
  for (int i = 0; i < 50; ++i) rig.cycle();
  rig.in.master_known = true;
  rig.in.master_age = 0;
  // Engaged claims, wild commands, none of them standing on the held pose.
  for (int i = 0; i < 200; ++i) {
    rig.in.master.desired = Desired::kEngaged;
    rig.in.master.state = static_cast<SessionState>(i % 6);
    rig.in.master.has_command = i % 2 == 0;
    rig.in.master.X_SU = {dice.within(0.5), dice.turn(3.0)};
    if (i % 5 == 0) rig.in.master.X_SU.p.x() = kNotANumber;
    rig.cycle();
    ASSERT_EQ(rig.joints(), start);
    ASSERT_FALSE(follows(rig.out.link.state));
  }
}

TEST(FollowSession, ACommandOffTheHeldPoseIsNotEngagedAndSaysSo) {
  FollowRig rig;
  rig.in.master_known = true;
  rig.in.master_age = 0;
  rig.in.master.desired = Desired::kEngaged;
  rig.in.master.state = SessionState::kAligning;
  rig.in.master.has_command = true;
  rig.in.master.X_SU = rig.state.motion.X_ST;
  rig.in.master.X_SU.p.x() += 2e-6;
  for (int i = 0; i < 20; ++i) rig.cycle();
  EXPECT_EQ(rig.out.link.state, SessionState::kAligning);
  EXPECT_EQ(rig.out.link.reason, Reason::kAlignmentMismatch);
  rig.in.master.X_SU = rig.state.motion.X_ST;
  rig.cycle();
  EXPECT_EQ(rig.out.link.state, SessionState::kEngaged);
}

// At the end of a joint's range every command is out of reach by what the planner keeps from it.
TEST(FollowSession, StandsUntilTheMasterIsEngagedToo) {
  JointVector end = test::home();
  end[2] = rv2a_limits().lower[2] + 1e-7;
  FollowRig rig(end);
  rig.in.master_known = true;
  rig.in.master.desired = Desired::kEngaged;
  rig.in.master.state = SessionState::kAligning;
  rig.in.master.has_command = true;
  const Pose X = rig.state.motion.X_ST;
  for (int i = 0; i < 10; ++i) {
    rig.follow(X);
    ASSERT_EQ(rig.joints(), end);
  }
  EXPECT_EQ(rig.out.link.state, SessionState::kEngaged);
  rig.in.master.state = SessionState::kEngaged;
  for (int i = 0; i < 10; ++i) rig.follow(X);
  EXPECT_NE(rig.joints(), end);
}

TEST(FollowSession, HoldsTheLatchedPoseUntilPlacedAndTakesNoCommand) {
  FollowRig rig;
  rig.state = FollowState();
  rig.in.q_measured = test::joints_deg(1, 2, 91, 4, 85, 6);
  rig.cycle();
  EXPECT_EQ(rig.out.q_target, test::joints_deg(1, 2, 91, 4, 85, 6));
  EXPECT_EQ(rig.out.link.reason, Reason::kRobotNotConnected);
  EXPECT_FALSE(rig.out.link.has_pose);
}

TEST(FollowSession, AStandingTargetGivesBitIdenticalJoints) {
  FollowRig rig;
  set_going(rig);
  for (int i = 0; i < 200; ++i) rig.cycle();
  const JointVector at_rest = rig.joints();
  for (int i = 0; i < 200; ++i) {
    rig.cycle();
    ASSERT_EQ(rig.joints(), at_rest);
  }
  EXPECT_LT((rig.tip.p - rig.in.master.X_SU.p).norm(), 1e-9);
}

TEST(FollowSession, ACommandBetween5And20MillisecondsOldSlowsAndSaysSo) {
  const auto speed_at = [](Nanos age) {
    FollowRig rig;
    set_going(rig);
    Pose far = rig.in.master.X_SU;
    far.p.y() += 0.1;
    rig.in.master.X_SU = far;
    rig.in.master_age = age;
    double last = 0.0;
    for (int i = 0; i < 15; ++i) {
      const double before = rig.tip.p.y();
      rig.cycle();
      last = rig.tip.p.y() - before;
    }
    EXPECT_EQ(rig.out.link.reason == Reason::kLinkStale, age > 5 * kMillisecond);
    EXPECT_EQ(rig.out.link.state, SessionState::kEngaged);
    return last;
  };
  const double full = speed_at(5 * kMillisecond);
  const double slow = speed_at(17 * kMillisecond);
  EXPECT_LT(slow, 0.7 * full);
  EXPECT_GT(slow, 0.0);
  EXPECT_LT(speed_at(20 * kMillisecond), 0.02 * full);
}

TEST(FollowSession, ACommandOver20MillisecondsOldStopsTheTipOnItsPathAndTheLinkResumesIt) {
  FollowRig rig;
  set_going(rig);
  const Pose start = rig.tip;
  rig.in.master.X_SU.p.y() += 0.1;
  rig.in.master_age = 20 * kMillisecond + 1;
  double last = start.p.y();
  int cycles_to_rest = 0;
  for (int i = 0; i < 25; ++i) {
    rig.cycle();
    EXPECT_EQ(rig.out.link.state, SessionState::kHold);
    EXPECT_EQ(rig.out.link.reason, Reason::kLinkHold);
    EXPECT_LT((rig.tip.p - Vec3(start.p.x(), rig.tip.p.y(), start.p.z())).norm(), kBesideItsWay);
    EXPECT_GE(rig.tip.p.y(), last);
    if (rig.tip.p.y() > last) ++cycles_to_rest;
    last = rig.tip.p.y();
  }
  EXPECT_GT(cycles_to_rest, 1);
  EXPECT_LT(cycles_to_rest, 15);
  rig.in.master_age = 0;
  for (int i = 0; i < 200; ++i) rig.cycle();
  EXPECT_EQ(rig.out.link.state, SessionState::kEngaged);
  EXPECT_LT((rig.tip.p - rig.in.master.X_SU.p).norm(), 1e-9);
  EXPECT_TRUE(rig.watch.kept());
}

TEST(FollowSession, AGapOfOver200MillisecondsLatchesAndAFreshLinkAloneDoesNotMoveTheArm) {
  FollowRig rig;
  set_going(rig);
  rig.in.master_age = 200 * kMillisecond;
  rig.cycle();
  EXPECT_EQ(rig.out.link.state, SessionState::kHold);
  rig.in.master_age = 200 * kMillisecond + 1;
  for (int i = 0; i < 30; ++i) rig.cycle();
  EXPECT_EQ(rig.out.link.state, SessionState::kFault);
  EXPECT_EQ(rig.out.link.fault, Reason::kLinkLost);
  const JointVector held = rig.joints();
  rig.in.master.X_SU.p.y() += 0.05;
  rig.in.master_age = 0;
  for (int i = 0; i < 50; ++i) {
    rig.cycle();
    ASSERT_EQ(rig.joints(), held);
  }
  EXPECT_EQ(rig.out.link.state, SessionState::kFault);
  rig.in.master.fault_reset = rig.out.link.fault_epoch;
  rig.in.master.state = SessionState::kOff;
  rig.in.master.desired = Desired::kOff;
  rig.cycle();
  EXPECT_EQ(rig.out.link.state, SessionState::kOff);
  EXPECT_EQ(rig.joints(), held);
}

TEST(FollowSession, AStopComesToRestOnThePathWithinTheLimits) {
  FollowRig rig;
  set_going(rig);
  const Pose start = rig.tip;
  rig.in.master.stop_epoch = 1;
  int cycles = 0;
  JointVector last;
  do {
    last = rig.joints();
    rig.cycle();
    ++cycles;
    EXPECT_LT((rig.tip.p - Vec3(start.p.x(), rig.tip.p.y(), start.p.z())).norm(), kBesideItsWay);
  } while (rig.joints() != last && cycles < 100);
  // 0.2 m/s is about a third of full speed here, which takes 0.15 s to leave.
  EXPECT_LT(cycles, 15);
  EXPECT_TRUE(rig.watch.kept());
}

TEST(FollowSession, TheFirstFaultStaysTheReasonUntilReset) {
  FollowRig rig;
  rig.engage();
  rig.in.fault = Reason::kRobotBadPacket;
  rig.cycle();
  rig.in.fault = Reason::kRobotLost;
  rig.in.master_age = kSecond;
  rig.cycle();
  EXPECT_EQ(rig.out.link.fault, Reason::kRobotBadPacket);
  EXPECT_EQ(rig.out.link.fault_epoch, 1u);
}

TEST(FollowSession, ARestartedMasterStopsTheArmAndHasToEngageAgain) {
  FollowRig rig;
  set_going(rig);
  rig.in.master.engagement_epoch = 99;
  rig.cycle();
  EXPECT_EQ(rig.out.link.reason, Reason::kSessionClosed);
  rig.in.master.X_SU.p.y() += 0.1;
  for (int i = 0; i < 30; ++i) rig.cycle();
  EXPECT_EQ(rig.out.link.state, SessionState::kOff);
  const JointVector held = rig.joints();
  for (int i = 0; i < 30; ++i) rig.cycle();
  EXPECT_EQ(rig.joints(), held);
}

TEST(FollowSession, ShutdownStopsTheArmOnItsPath) {
  FollowRig rig;
  set_going(rig);
  const Vec3 start = rig.tip.p;
  rig.in.shutdown = true;
  for (int i = 0; i < 30; ++i) {
    rig.cycle();
    EXPECT_LT((rig.tip.p - Vec3(start.x(), rig.tip.p.y(), start.z())).norm(), kBesideItsWay);
  }
  EXPECT_EQ(rig.out.link.state, SessionState::kOff);
  EXPECT_EQ(rig.out.link.reason, Reason::kShutdown);
  EXPECT_TRUE(standing(rig.state.motion));
}

TEST(FollowSession, ACommandThatIsNoPoseIsNotTakenAndTheNextGoodOneIs) {
  Pose bad[6];
  bad[0].p.x() = kNotANumber;
  bad[1].p.z() = std::numeric_limits<double>::infinity();
  bad[2].q = Quat(kNotANumber, 0, 0, 0);
  bad[3].q = Quat(0, 0, 0, 0);
  bad[4].q = Quat(1.1, 0, 0, 0);
  bad[5].p.y() = 1e200;
  for (const Pose& X : bad) {
    FollowRig rig;
    set_going(rig);
    const Pose good = rig.in.master.X_SU;
    const Vec3 start = rig.tip.p;
    rig.follow(X);
    EXPECT_EQ(rig.out.link.reason, Reason::kCommandInvalid);
    EXPECT_EQ(rig.out.link.state, SessionState::kEngaged);
    for (int i = 0; i < 20; ++i) rig.follow(X);
    EXPECT_LT((rig.tip.p - Vec3(start.x(), rig.tip.p.y(), start.z())).norm(), kBesideItsWay);
    EXPECT_TRUE(standing(rig.state.motion));
    for (int i = 0; i < 100; ++i) rig.follow(good);
    EXPECT_LT((rig.tip.p - good.p).norm(), 1e-9);
    EXPECT_TRUE(rig.watch.kept());
  }
}

TEST(FollowSession, AClutchedMasterLeavesTheArmWhereItsCommandIs) {
  FollowRig rig;
  set_going(rig);
  rig.in.master.desired = Desired::kClutched;
  rig.in.master.state = SessionState::kClutched;
  for (int i = 0; i < 100; ++i) rig.cycle();
  EXPECT_EQ(rig.out.link.state, SessionState::kClutched);
  EXPECT_LT((rig.tip.p - rig.in.master.X_SU.p).norm(), 1e-9);
}

TEST(FollowSession, TellsTheOldestCommandItEverMovedToward) {
  FollowRig rig;
  set_going(rig);
  rig.in.master_age = 17 * kMillisecond;
  rig.cycle();
  rig.in.master_age = 30 * kMillisecond;
  rig.cycle();
  EXPECT_EQ(rig.out.link.oldest_applied, 17 * kMillisecond);
}

}  // namespace
}  // namespace handrail
