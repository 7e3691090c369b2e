// What a picture needs of the status: geometry, joints, the way out as orders.
#include <gtest/gtest.h>

#include "server/base/units.h"
#include "server/kinematics/rv2a.h"
#include "server/master/status_report.h"
#include "server/master/way_out.h"

namespace handrail {
namespace {

void expect_numbers(const google::protobuf::RepeatedField<double>& got,
                    const std::vector<double>& want) {
  ASSERT_EQ(got.size(), static_cast<int>(want.size()));
  for (int i = 0; i < got.size(); ++i) EXPECT_NEAR(got[i], want[static_cast<std::size_t>(i)], 1e-9);
}

class DrawnStatusTest : public ::testing::Test {
 protected:
  DrawnStatusTest() {
    link.peer_epoch = 1;
    link.received_at = now;
    slave.has_pose = true;
    slave.q_measured << 0.1, 0.2, 1.3, 0.0, 1.2, -0.4;
    slave.X_ST = slave.X_ST_command = forward(ArmGeometry(), slave.q_measured);
    report.out.link.state = slave.state = SessionState::kEngaged;
  }
  pb::Status status() const { return status_report(identity, report, slave, link, now); }
  // Orders of the way out, in short.
  std::string orders() const {
    std::string out;
    const pb::Status s = status();
    for (const pb::Request& request : s.ledger().way_out_order()) {
      out += (out.empty() ? "" : " ") + request.ShortDebugString();
    }
    return out;
  }

  MasterIdentity identity;
  HapticReport report;
  SlaveState slave;
  LinkSnapshot link;
  Nanos now = 50 * kSecond;
};

TEST_F(DrawnStatusTest, ALineHasItsAnchorItsWayAndItsEnd) {
  ToolDefinition& line = report.out.link.position_tool;
  line.kind = ToolKind::kLine;
  line.p_SA = Vec3(0.3, 0.1, 0.2);
  line.direction_S = Vec3(0.6, 0.0, 0.8);
  line.has_end = line.one_way = true;
  line.end = 0.1;
  const pb::ToolGeometry drawn = status().position_tool().geometry();
  expect_numbers(drawn.anchor_mm(), {300, 100, 200});
  expect_numbers(drawn.direction(), {0.6, 0, 0.8});
  expect_numbers(drawn.end_mm(), {360, 100, 280});
  EXPECT_TRUE(drawn.one_way());
  EXPECT_EQ(drawn.normal_size(), 0);
  EXPECT_FALSE(status().orientation_tool().has_geometry()) << "there is none";
}

TEST_F(DrawnStatusTest, APlaneHasItsNormalAndOrientationToolsWhatTheyKeep) {
  ToolDefinition& plane = report.out.link.position_tool;
  plane.kind = ToolKind::kPlane;
  plane.normal_S = Vec3::UnitZ();
  expect_numbers(status().position_tool().geometry().normal(), {0, 0, 1});
  EXPECT_EQ(status().position_tool().geometry().direction_size(), 0) << "it leads no way";
  ToolDefinition& kept = report.out.link.orientation_tool;
  kept.kind = ToolKind::kNRotation;
  kept.q_ref = Quat(0.0, 1.0, 0.0, 0.0);
  expect_numbers(status().orientation_tool().geometry().quaternion(), {0, 1, 0, 0});
  kept.kind = ToolKind::kFRotation;
  kept.normal_S = Vec3(0, 1, 0);
  kept.axis_T = Vec3(0, 0, 1);
  const pb::ToolGeometry turns = status().orientation_tool().geometry();
  expect_numbers(turns.axis(), {0, 1, 0});
  expect_numbers(turns.axis_tip(), {0, 0, 1});
  EXPECT_EQ(turns.anchor_mm_size(), 0);
}

TEST_F(DrawnStatusTest, TheJointsCommandedAreThoseOfTheCommandOnTheArmsBranch) {
  JointVector command = slave.q_measured;
  command[0] += 2.0 * kDeg;
  command[3] -= 3.0 * kDeg;
  slave.X_ST_command = forward(ArmGeometry(), command);
  pb::Status s = status();
  show_joints(ArmGeometry(), slave, s);
  ASSERT_EQ(s.joints_deg_size(), 6);
  ASSERT_EQ(s.joints_commanded_deg_size(), 6);
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(s.joints_deg(i), slave.q_measured[i] / kDeg, 1e-9) << i;
    EXPECT_NEAR(s.joints_commanded_deg(i), command[i] / kDeg, 1e-6) << i;
  }
}

TEST_F(DrawnStatusTest, AnArmThatIsNotHeardHasNoJoints) {
  link.peer_epoch = 0;
  pb::Status s = status();
  show_joints(ArmGeometry(), slave, s);
  EXPECT_EQ(s.joints_deg_size(), 0);
  EXPECT_EQ(s.joints_commanded_deg_size(), 0);
}

TEST_F(DrawnStatusTest, WhereTheHandWantsTheTipIsBeforeEverythingThatMovesIt) {
  EXPECT_FALSE(status().has_desired_tip()) << "the hand does not lead";
  report.out.motion.known = true;
  report.out.motion.off_S.col(0) = Vec3(0.01, 0, 0);
  report.out.motion.off_S.col(4) = Vec3(0, -0.02, 0);
  report.out.motion.q_SH = Quat(0.0, 0.0, 1.0, 0.0);
  const Vec3 want = (slave.X_ST_command.p - Vec3(0.01, -0.02, 0)) / kMm;
  expect_numbers(status().desired_tip().position_mm(), {want.x(), want.y(), want.z()});
  expect_numbers(status().desired_tip().quaternion(), {0, 0, 1, 0});
}

TEST_F(DrawnStatusTest, TheDeviceIsAsItSaysAndTheHandAmongTheWallsIsInTheirFrame) {
  identity.workspace_half = Vec3(0.08, 0.06, 0.035);
  identity.max_force = 3.3;
  identity.device_turns = true;
  report.walls.present = true;
  report.walls.hand = Vec2(0.012, -0.003);
  report.walls.force = Vec2(-4.0, 1.5);
  const pb::Status s = status();
  expect_numbers(s.haptic().workspace_half_mm(), {80, 60, 35});
  EXPECT_EQ(s.haptic().max_force_n(), 3.3);
  EXPECT_TRUE(s.haptic().has_rotation());
  expect_numbers(s.walls().hand_mm(), {12, -3});
  expect_numbers(s.walls().force_n(), {-4, 1.5});
}

TEST_F(DrawnStatusTest, TheWayOutIsOrdersWhereOrdersHelp) {
  report.out.link.state = slave.state = SessionState::kOff;
  report.out.reason = slave.reason = Reason::kNotEngaged;
  EXPECT_EQ(orders(), "engage: true");
  report.out.link.state = SessionState::kFault;
  report.out.reason = Reason::kStopRequested;
  EXPECT_EQ(orders(), "reset: true engage: true");
  report.out.link.state = SessionState::kClutched;
  report.out.reason = Reason::kNone;
  EXPECT_EQ(orders(), "clutch: false");
  report.out.link.state = slave.state = SessionState::kEngaged;
  EXPECT_EQ(orders(), "") << "nothing is wrong";
  report.walls.present = true;
  report.out.link.state = SessionState::kOff;
  EXPECT_EQ(orders(), "") << "there is nothing to engage";
  report.out.link.stop_epoch = 1;
  EXPECT_EQ(orders(), "reset: true");
}

TEST_F(DrawnStatusTest, WhoeverLostTheLeaseTakesItBeforeEngaging) {
  using enum WayOutOrder;
  EXPECT_EQ(orders_out_of(Reason::kLeaseLost, Stand::kOff),
            (std::vector<WayOutOrder>{kTakeLease, kEngage}));
  EXPECT_EQ(orders_out_of(Reason::kSensorStuck, Stand::kLatched),
            (std::vector<WayOutOrder>{kReset, kEngage}));
  EXPECT_TRUE(orders_out_of(Reason::kLinkHold, Stand::kLed).empty()) << "it goes on by itself";
}

}  // namespace
}  // namespace handrail
