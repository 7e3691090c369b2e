// One line for a person, from ledgers made by hand.
#include "server/master/why_report.h"

#include <gtest/gtest.h>

#include "server/base/units.h"
#include "server/kinematics/rv2a.h"

namespace handrail {
namespace {

class WhyReportTest : public ::testing::Test {
 protected:
  WhyReportTest() {
    link.peer_epoch = 1;
    link.received_at = now;
    link.echoed_sent = now - 62 * kMillisecond;
    report.out.link.state = slave.state = SessionState::kEngaged;
    report.out.motion.known = true;
  }
  void off(MotionStage stage, const Vec3& mm, Reason why) {
    const auto i = static_cast<std::size_t>(stage);
    report.out.motion.off_S.col(static_cast<Eigen::Index>(i)) = mm * kMm;
    report.out.motion.why[i] = why;
  }
  // The arm is turned by as many degrees at each step from the hand on.
  void turn(double tool, double smoother, double slave_turn) {
    MotionLedger& ledger = report.out.motion;
    const auto on = [](const Quat& q, double deg) {
      return Quat(q * rotation_exp({deg * kDeg, 0, 0}));
    };
    ledger.q_SP = on(ledger.q_SH, tool);
    ledger.q_SU = on(ledger.q_SP, smoother);
    ledger.q_ST = on(ledger.q_SU, slave_turn);
  }
  pb::Ledger why() const {
    pb::Ledger out;
    set_ledger(&out, report, slave, link, now);
    return out;
  }

  HapticReport report;
  SlaveState slave;
  LinkSnapshot link;
  Nanos now = 50 * kSecond;
};

TEST_F(WhyReportTest, NamesTheLargestStagesFirstWithTheirReasonsAndTheWayOut) {
  off(MotionStage::kTool, Vec3(0, 0.3, 0), Reason::kNone);
  off(MotionStage::kLink, Vec3(2.1, 0, 0), Reason::kNone);
  off(MotionStage::kLimits, Vec3(11.8, 0, 0), Reason::kJointAcceleration);
  off(MotionStage::kReach, Vec3(0.19, 0, 0), Reason::kOutOfReach);
  report.out.motion.joint = 0;
  const pb::Ledger out = why();
  EXPECT_EQ(out.sentence(), std::string("the arm is 14.1 mm from the hand: 11.8 mm limits: ") +
                                describe(Reason::kJointAcceleration) +
                                " (J1); 2.1 mm link (loop 62 ms); 0.3 mm tool");
  EXPECT_EQ(out.way_out(), "wait, or move slower");
  EXPECT_EQ(out.joint(), 1u);
}

TEST_F(WhyReportTest, TheNumbersAreTheLedgersAndAddUp) {
  off(MotionStage::kSmoother, Vec3(1, 2, 3), Reason::kNone);
  off(MotionStage::kSingularity, Vec3(-1, 0, 1), Reason::kSingularity);
  report.out.force.tool = Vec3(3, 0, 4);
  report.out.force.device = Vec3(0, 0, 2);
  const pb::Ledger out = why();
  ASSERT_EQ(out.motion_size(), 8);
  Vec3 sum = Vec3::Zero();
  for (const pb::MotionShare& stage : out.motion()) {
    ASSERT_EQ(stage.offset_mm_size(), 3);
    sum += Vec3(stage.offset_mm(0), stage.offset_mm(1), stage.offset_mm(2));
  }
  EXPECT_NEAR(sum.norm(), out.behind_mm(), 1e-12);
  EXPECT_EQ(out.motion(1).stage(), "smoother");
  EXPECT_EQ(out.motion(1).reason(), "smoothing");
  EXPECT_EQ(out.motion(0).reason(), "none");
  EXPECT_EQ(out.motion(7).reason(), describe(Reason::kSingularity));
  EXPECT_DOUBLE_EQ(out.tool().magnitude_n(), 5.0);
  EXPECT_DOUBLE_EQ(out.device().force_n(2), 2.0);
}

TEST_F(WhyReportTest, WhatTheGovernorTakesIsSaidWhereAHandNoticesIt) {
  const std::string alone = why().sentence();
  report.out.force.governor = Vec3(0.03, 0, -0.04);
  EXPECT_EQ(why().sentence(), alone);
  report.out.force.governor = Vec3(0.3, 0, -0.4);
  EXPECT_EQ(why().sentence(),
            alone + "; the hand feels 0.5 N less: force lowered so that it makes no energy");
}

TEST_F(WhyReportTest, AnArmThatHoldsSaysWhyBeforeAnyNumber) {
  off(MotionStage::kLimits, Vec3(50, 0, 0), Reason::kJointSpeed);
  report.out.link.state = SessionState::kFault;
  report.out.reason = Reason::kLinkLost;
  EXPECT_EQ(why().sentence(), std::string("the arm holds: ") + describe(Reason::kLinkLost));
  EXPECT_EQ(why().way_out(), "reset, then engage");
  report.out.reason = Reason::kPeerFault;
  report.out.peer_fault = Reason::kStopInput;  // the slave itself has been started anew
  EXPECT_EQ(why().sentence(), std::string("the arm holds: ") + describe(Reason::kStopInput));
  EXPECT_EQ(why().way_out(), "close the stop circuit, then reset and engage");
  report.good_until = now - 1;
  EXPECT_EQ(why().sentence(), std::string("the arm holds: ") + describe(Reason::kThreadStalled));
}

// A stop, or a lost link, on top of another trouble: a reset alone would meet that again.
TEST_F(WhyReportTest, WhatIsStillWrongBesideAFaultIsSaidAndComesFirst) {
  report.out.link.state = slave.state = SessionState::kFault;
  report.out.reason = Reason::kStopRequested;
  link.received_at = now;
  EXPECT_EQ(why().way_out(), "reset, then engage");
  slave.obstacle = Reason::kSensorMissing;
  EXPECT_EQ(why().sentence(), std::string("the arm holds: ") + describe(Reason::kStopRequested) +
                                  "; and " + describe(Reason::kSensorMissing));
  EXPECT_EQ(why().way_out(), "check the force sensor, then reset and engage");
  link.received_at = now - kSecond;  // what it said is old
  EXPECT_EQ(why().way_out(), "reset, then engage");
}

TEST_F(WhyReportTest, AMasterThatHasJustStartedNamesTheFaultThatItsSlaveIsIn) {
  report.out.link.state = SessionState::kOff;
  report.out.reason = Reason::kNotEngaged;
  EXPECT_EQ(why().way_out(), "engage");
  slave.state = SessionState::kFault;
  slave.fault = Reason::kLinkLost;
  link.received_at = now;
  EXPECT_EQ(why().sentence(), std::string("the arm holds: ") + describe(Reason::kLinkLost));
  EXPECT_EQ(why().way_out(), "reset, then engage");
  slave.fault = Reason::kRobotLost;
  EXPECT_TRUE(why().way_out().starts_with("at the controller: "));
}

TEST_F(WhyReportTest, ASlaveThatIsNotReadySaysWhyBeforeAnybodyEngages) {
  report.out.link.state = SessionState::kOff;
  report.out.reason = Reason::kNotEngaged;
  slave.reason = Reason::kRobotNotConnected;
  link.received_at = now;
  EXPECT_EQ(why().sentence(),
            std::string("the arm holds: ") + describe(Reason::kRobotNotConnected));
  EXPECT_TRUE(why().way_out().starts_with("at the controller: "));
  link.received_at = now - kSecond;  // what it said is old
  EXPECT_EQ(why().way_out(), "engage");
}

TEST_F(WhyReportTest, WhileOffItNamesWhatWouldRefuseAnEngageAndTheWayOutOfThat) {
  report.out.link.state = slave.state = SessionState::kOff;
  report.out.reason = slave.reason = Reason::kNotEngaged;
  EXPECT_EQ(why().way_out(), "engage");
  for (const Reason obstacle : {Reason::kNoPeer, Reason::kSessionClosed, Reason::kHashLimits,
                                Reason::kSceneDiffers, Reason::kPresence, Reason::kDeviceInvalid}) {
    report.out.obstacle = obstacle;
    EXPECT_EQ(why().sentence(), std::string("the arm holds: ") + describe(obstacle));
    EXPECT_NE(why().way_out(), "engage") << describe(obstacle);
    EXPECT_NE(why().way_out(), "") << describe(obstacle);
  }
  report.out.reason = Reason::kLeaseLost;  // what ended the last engagement is over
  EXPECT_EQ(why().sentence(), std::string("the arm holds: ") + describe(Reason::kDeviceInvalid));
  report.out.obstacle = Reason::kPeerFault;
  slave.state = SessionState::kFault;
  slave.fault = Reason::kStopInput;
  EXPECT_EQ(why().sentence(), std::string("the arm holds: ") + describe(Reason::kStopInput));
  report.out.obstacle = Reason::kPresence;  // nor does an arm that is not ready wait for it
  slave.state = SessionState::kOff;
  slave.reason = Reason::kRobotNotConnected;
  EXPECT_TRUE(why().way_out().starts_with("at the controller: "));
}

TEST_F(WhyReportTest, WhereNothingIsLatchedNoWayOutNamesAReset) {
  const auto resets = [this](Reason obstacle) {
    report.out.obstacle = obstacle;
    return why().way_out().find("reset") != std::string::npos;
  };
  report.out.link.state = slave.state = SessionState::kOff;
  report.out.reason = slave.reason = Reason::kNotEngaged;
  for (int i = 1; i < static_cast<int>(Reason::kCount); ++i) {
    EXPECT_FALSE(resets(static_cast<Reason>(i))) << describe(static_cast<Reason>(i));
  }
  report.out.obstacle = Reason::kNone;
  slave.reason = Reason::kSensorMissing;
  EXPECT_EQ(why().way_out(), "check the force sensor, then engage");
  slave.state = SessionState::kFault;
  slave.fault = Reason::kSensorMissing;
  EXPECT_EQ(why().way_out(), "check the force sensor, then reset and engage");
}

TEST_F(WhyReportTest, AnArmThatPressesBeyondTheSensorsRangeHasAWayBack) {
  report.out.link.state = slave.state = SessionState::kFault;
  report.out.reason = slave.fault = slave.reason = Reason::kSensorOverrange;
  EXPECT_EQ(why().way_out(),
            "move the arm off what it presses on, at the controller or led in a scene without a "
            "bumper; where it presses on nothing, check the force sensor, then reset and engage");
}

TEST_F(WhyReportTest, WallsWithoutAnArmHaveAWayOut) {
  report.walls.present = true;
  report.out.link.state = SessionState::kOff;
  EXPECT_EQ(why().sentence(), std::string("the arm holds: ") + describe(Reason::kNoArmInScene));
  EXPECT_EQ(why().way_out(), "load a scene with an arm: 'handrail scene load NAME', then engage");
}

TEST_F(WhyReportTest, WallsLoadedInAnotherFaultThanAStopAreFelt) {
  report.walls.present = true;
  report.out.link.state = SessionState::kFault;
  report.out.reason = Reason::kLinkLost;
  EXPECT_EQ(why().sentence(), std::string("the arm holds: ") + describe(Reason::kNoArmInScene));
  EXPECT_EQ(why().way_out(),
            "load a scene with an arm: 'handrail scene load NAME', then reset and engage");
}

TEST_F(WhyReportTest, StoppedWallsAreReleasedByAResetAlone) {
  report.walls.present = true;
  report.out.link.state = SessionState::kFault;
  report.out.reason = Reason::kStopRequested;
  report.out.link.stop_epoch = report.out.link.released_epoch + 1;
  EXPECT_EQ(why().sentence(), "the walls are not felt: a stop was requested");
  EXPECT_EQ(why().way_out(), "reset");
}

TEST_F(WhyReportTest, AControllerThatIsNotHeardIsNotBlamedOnTheLink) {
  off(MotionStage::kLink, Vec3(5.0, 0, 0), Reason::kNone);
  slave.reason = Reason::kRobotSilent;
  EXPECT_EQ(why().sentence(), std::string("the arm is 5.0 mm from the hand: 5.0 mm controller: ") +
                                  describe(Reason::kRobotSilent));
  EXPECT_TRUE(why().way_out().starts_with("wait: it goes on by itself")) << why().way_out();
  EXPECT_EQ(why().motion(static_cast<int>(MotionStage::kLink)).stage(), "controller");
  slave.reason = Reason::kNone;
  EXPECT_EQ(why().motion(static_cast<int>(MotionStage::kLink)).stage(), "link");
}

TEST_F(WhyReportTest, PartsThatCancelAreSaidTo) {
  off(MotionStage::kTool, Vec3(4.0, 0, 0), Reason::kNone);
  off(MotionStage::kLimits, Vec3(-3.0, 0, 0), Reason::kJointSpeed);
  EXPECT_TRUE(why().sentence().starts_with(
      "the arm is 1.0 mm from the hand, as these partly cancel: 4.0 mm tool; 3.0 mm limits"))
      << why().sentence();
  off(MotionStage::kLimits, Vec3(0, 3.0, 0), Reason::kJointSpeed);
  EXPECT_TRUE(why().sentence().starts_with("the arm is 5.0 mm from the hand: 4.0 mm tool"));
}

TEST_F(WhyReportTest, TurnsThatCancelAreSaidTo) {
  turn(4.0, -3.0, 0);
  EXPECT_TRUE(why().sentence().starts_with(
      "the arm is 1.0 deg from the hand, as these partly cancel: 4.0 deg tool"))
      << why().sentence();
  turn(4.0, 3.0, 0);
  EXPECT_TRUE(why().sentence().starts_with("the arm is 7.0 deg from the hand: 4.0 deg tool"));
}

TEST_F(WhyReportTest, NamesTheMasterThatLeadsTheSlaveAndTheWayOut) {
  report.out.link.state = SessionState::kFault;
  report.out.reason = Reason::kLinkLost;
  link.received_at = now - 5 * kSecond;
  link.refused_at = now;
  link.refusal = {1, false, fixed_text<LeaderName>("process 4711"), 3 * kSecond};
  EXPECT_EQ(why().sentence(),
            "the arm holds: the slave is led by another master (process 4711, "
            "for 3 s)");
  EXPECT_EQ(why().way_out(),
            "end that master: then the slave takes this one, without a restart, then reset "
            "and engage");
  report.out.link.state = SessionState::kOff;
  slave.state = SessionState::kFault;  // said before the other led it
  EXPECT_EQ(why().way_out(),
            "end that master: then the slave takes this one, without a restart, then engage");
}

TEST_F(WhyReportTest, SmoothingIsNoToolChange) {
  off(MotionStage::kSmoother, Vec3(0, 0, 4.7), Reason::kNone);
  EXPECT_EQ(why().sentence(), "the arm is 4.7 mm from the hand: 4.7 mm smoothing");
  EXPECT_EQ(why().way_out(), "");
  off(MotionStage::kSmoother, Vec3(0, 0, 4.7), Reason::kToolBlending);
  EXPECT_EQ(why().sentence(),
            "the arm is 4.7 mm from the hand: 4.7 mm easing after a change of tool");
  turn(0, 3.0, 0);
  off(MotionStage::kSmoother, Vec3(0, 0, 1.0), Reason::kNone);
  EXPECT_EQ(why().sentence(),
            "the arm is 1.0 mm and 3.0 deg from the hand: 1.0 mm and 3.0 deg smoothing");
  report.out.motion.eased_angle = 2.0 * kDeg;
  EXPECT_EQ(why().motion(1).reason(), "easing after a change of tool");
}

TEST_F(WhyReportTest, ATipInItsPlaceButTurnedIsSaidInDegrees) {
  turn(3.2, 0, 0);
  pb::Ledger out = why();
  EXPECT_EQ(out.sentence(),
            "the arm is 3.2 deg from the hand: 3.2 deg tool: kept on the active tool");
  EXPECT_NEAR(out.behind_deg(), 3.2, 1e-9);
  EXPECT_NEAR(out.motion(0).deg(), 3.2, 1e-9);
  // What the slave turned is the stage's that acts there; without one it is on its way.
  turn(0, 0, 1.4);
  EXPECT_EQ(why().sentence(), "the arm is 1.4 deg from the hand: 1.4 deg link (loop 62 ms)");
  slave.ledger.why[static_cast<std::size_t>(FollowStage::kLimits)] = Reason::kSingularity;
  report.out.motion.joint = 3;
  out = why();
  EXPECT_EQ(out.sentence(), std::string("the arm is 1.4 deg from the hand: 1.4 deg singularity: ") +
                                describe(Reason::kSingularity) + " (J4)");
  EXPECT_EQ(out.motion(7).reason(), describe(Reason::kSingularity));
  off(MotionStage::kLimits, Vec3(1.5, 0, 0), Reason::kJointSpeed);
  EXPECT_EQ(why().way_out(), "wait, or move slower") << "the largest decides";
  turn(0, 0, 0.19);
  off(MotionStage::kLimits, Vec3(0.1, 0, 0), Reason::kJointSpeed);
  EXPECT_EQ(why().sentence(), "the arm is 0.1 mm from the hand");
}

TEST_F(WhyReportTest, TheWayOutIsOfTheJointAndTheSingularityTheArmIsAt) {
  const auto way_out = [this](MotionStage stage, Reason reason) {
    report.out.motion.off_S.setZero();
    off(stage, Vec3(5, 0, 0), reason);
    return why().way_out();
  };
  report.out.motion.joint = 4;
  EXPECT_EQ(way_out(MotionStage::kLimits, Reason::kJointRange), "turn J5 back");
  EXPECT_EQ(way_out(MotionStage::kReach, Reason::kOutOfReach), "come back toward the base");
  // Its face may be the one toward the base.
  EXPECT_EQ(way_out(MotionStage::kReach, Reason::kWorkspace), "come back into the workspace");
  slave.q_measured << 0.2, 0.3, 1.5, 0.4, 0.01, 0.5;
  EXPECT_EQ(way_out(MotionStage::kSingularity, Reason::kSingularity),
            "tilt the tip away from the forearm's axis");
  // Leaning back until the wrist's centre is over the base.
  slave.q_measured << 0.2, -1.0, 2.2, 0.4, 0.8, 0.5;
  const auto off_axis = [this] {
    return singularity_margin(ArmGeometry(), slave.q_measured).shoulder;
  };
  while (off_axis() > 2e-3 && slave.q_measured[1] > -2.0) slave.q_measured[1] -= 1e-3;
  ASSERT_LE(off_axis(), 2e-3);
  EXPECT_EQ(way_out(MotionStage::kSingularity, Reason::kSingularity),
            "move out from the base axis");
}

TEST_F(WhyReportTest, AHandWhoseReadingIsMissingIsTheReason) {
  report.out.motion.known = false;
  report.out.reason = Reason::kDeviceInvalid;
  EXPECT_EQ(why().sentence(), std::string("the arm holds: ") + describe(Reason::kDeviceInvalid));
}

TEST_F(WhyReportTest, AnArmThatFollowsHasNoWayOutToSay) {
  off(MotionStage::kTool, Vec3(0.1, 0, 0), Reason::kNone);
  EXPECT_EQ(why().sentence(), "the arm is 0.1 mm from the hand");
  EXPECT_EQ(why().way_out(), "");
}

TEST_F(WhyReportTest, OfABadLinkTheFiguresComeBeforeItsBadMoments) {
  report.out.link.state = slave.state = SessionState::kOff;
  report.out.obstacle = Reason::kLinkQuality;
  report.out.link_window = kSecond;
  report.out.link_shares.heard = 1.0;
  report.out.link_shares.lost = 0.603;
  for (const Reason moment : {Reason::kNone, Reason::kLinkStale, Reason::kLinkHold}) {
    slave.reason = moment;
    EXPECT_EQ(why().sentence(),
              "the arm holds: the link is not good enough: 60.3 % lost on the "
              "way here, at most 25 % in 1 s is asked");
    EXPECT_EQ(why().way_out(), "wait for the link, then engage");
  }
  slave.reason = Reason::kRobotNotConnected;
  EXPECT_NE(why().sentence().find(describe(Reason::kRobotNotConnected)), std::string::npos);
}

}  // namespace
}  // namespace handrail
