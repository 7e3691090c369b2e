// One line for a person, from ledgers made by hand.
#include "server/master/why_report.h"

#include <gtest/gtest.h>

#include "server/base/units.h"

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
  EXPECT_EQ(out.way_out(), "move slower");
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
  EXPECT_EQ(out.motion(7).reason(), describe(Reason::kSingularity));
  EXPECT_DOUBLE_EQ(out.tool().magnitude_n(), 5.0);
  EXPECT_DOUBLE_EQ(out.device().force_n(2), 2.0);
}

TEST_F(WhyReportTest, AnArmThatHoldsSaysWhyBeforeAnyNumber) {
  off(MotionStage::kLimits, Vec3(50, 0, 0), Reason::kJointSpeed);
  report.out.link.state = SessionState::kFault;
  report.out.reason = Reason::kLinkLost;
  EXPECT_EQ(why().sentence(), std::string("the arm holds: ") + describe(Reason::kLinkLost));
  EXPECT_EQ(why().way_out(), "reset, then engage");
  report.out.reason = Reason::kPeerFault;
  slave.fault = Reason::kStopInput;
  EXPECT_EQ(why().sentence(), std::string("the arm holds: ") + describe(Reason::kStopInput));
  report.good_until = now - 1;
  EXPECT_EQ(why().sentence(), std::string("the arm holds: ") + describe(Reason::kThreadStalled));
}

TEST_F(WhyReportTest, AnArmThatFollowsHasNoWayOutToSay) {
  off(MotionStage::kTool, Vec3(0.1, 0, 0), Reason::kNone);
  EXPECT_EQ(why().sentence(), "the arm is 0.1 mm from the hand");
  EXPECT_EQ(why().way_out(), "");
}

}  // namespace
}  // namespace handrail
