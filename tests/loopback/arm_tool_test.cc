// What is fixed to the arm. A bent tool: scene, both daemons and the simulated arm agree on where
// its tip is, tools hold that tip, and the force sensor, which is turned as the flange, is read
// right. A gripper: command line, both daemons, the outputs of the controller.
#include <gmock/gmock.h>

#include "server/base/units.h"
#include "tests/loopback/whole_cell.h"
#include "tests/support/kdl_arm.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class MountedToolTest : public WholeCell {
 protected:
  void SetUp() override {
    folder.write(
        "bent.scene",
        "name: 'bent' mapping { scale: 4 }\n"
        "robot { tip_length_mm: 150 mount { offset_mm: [40, 0, 25] turn_deg: [0, 60, 0] } }\n"
        "simulate { effect { servo_lag { lag_ms: 45 } }\n"
        "           effect { plane { at_mm: [0, 0, 450] normal: [0, 0, 1] } } }\n");
    const std::string at = "scene: 'bent' scene_path: '" + folder.path() + "'";
    rig_extra = at;
    slave_extra = at;
    master_extra = "scene: 'bent'";
    WholeCell::SetUp();
  }
  // What the measured joints and the mount make of it, by KDL [mm, deg].
  static Pose by_kdl(const pb::Status& s) {
    test::KdlForward to_a(150.0);
    JointVector q;
    for (int i = 0; i < kJoints; ++i) q[i] = s.joints_deg(i) * kDeg;
    const Pose A = to_a(q);
    const Vec3 aside(0.040, 0.0, 0.025);
    return {A.q * aside + A.p, A.q * Quat(Eigen::AngleAxisd(60 * kDeg, Vec3::UnitY()))};
  }
};

TEST_F(MountedToolTest, ItsTipIsWhatStaysOnALineWhileItTurns) {
  order("engage: true");
  const pb::Status start = at_rest();
  ASSERT_TRUE(start.mounted());
  EXPECT_LT((by_kdl(start).p / kMm - mm(start.tip())).norm(), 0.01);
  const auto& c = start.tip().quaternion();
  EXPECT_LT(angle_between(by_kdl(start).q, Quat(c[0], c[1], c[2], c[3])), 1e-3);
  const Vec3 from = mm(start.slave_command());
  order("tool { kind: LINE direction: [0, 1, 0] }");
  order("hand { displacement_mm: [-8, 6, 4] rotation_deg: [10, 20, 30] duration_s: 1 }");
  double off = 0.0;
  ASSERT_TRUE(eventually([&](const pb::Status& s) {
    const Vec3 at = mm(s.slave_command()) - from;
    off = std::max(off, std::hypot(at.x(), at.z()));
    return !s.hand_moving() && at.norm() > 5.0;
  }));
  EXPECT_LT(off, 1e-3) << "mm beside the line";
  const pb::Status end = at_rest();
  EXPECT_LT((by_kdl(end).p / kMm - mm(end.tip())).norm(), 0.05);
  const auto& a = start.slave_command().quaternion();
  const auto& b = end.slave_command().quaternion();
  EXPECT_GT(angle_between(Quat(a[0], a[1], a[2], a[3]), Quat(b[0], b[1], b[2], b[3])), 15 * kDeg);
  EXPECT_THAT(handrail({"calibrate", "payload", "--out", folder.path() + "/p.conf"}).second,
              HasSubstr("the scene mounts the tool aside"));
}

// The plane is level, the tip points aside, the flange straight down.
TEST_F(MountedToolTest, AFloorPushesItStraightUp) {
  order("engage: true");
  const Vec3 from = mm(at_rest().tip());
  ASSERT_GT(from.z(), 451.0);
  pb::Status touching;
  order("tool { kind: LINE direction: [0, 0, 1] }");
  // Up at the hand is up at the arm; four times as far.
  order("hand { displacement_mm: [0, " + std::to_string(-(from.z() - 447.0) / 4.0) +
        ", 0] duration_s: 3 }");
  ASSERT_TRUE(eventually([&](const pb::Status& s) {
    touching = s;
    return s.contact_force_n_size() == 3 && s.contact_force_n(2) > 2.0 && !s.hand_moving();
  }));
  const Vec3 force(touching.contact_force_n(0), touching.contact_force_n(1),
                   touching.contact_force_n(2));
  EXPECT_LT(std::hypot(force.x(), force.y()), 0.2 * force.z()) << force.transpose();
}

class GripperTest : public WholeCell {
 protected:
  void SetUp() override {
    robot_extra = "gripper { close_output: 900 open_output: 901 }";
    WholeCell::SetUp();
  }
  bool is(const std::string& state) {
    return eventually([&](const pb::Status& s) { return s.gripper() == state; });
  }
};

TEST_F(GripperTest, HoldsWhatItHoldsUntilItIsToldToLetGo) {
  ASSERT_TRUE(is("between")) << "a controller that was told nothing";
  const auto [early, told] = handrail({"robot", "grip"});
  EXPECT_EQ(early, 1);
  EXPECT_THAT(told, HasSubstr("refused: not engaged"));
  order("engage: true");
  const auto [code, answer] = handrail({"robot", "grip"});
  EXPECT_EQ(code, 0) << answer;
  EXPECT_EQ(status().gripper(), "closed");
  EXPECT_THAT(handrail({"status"}).second, HasSubstr("gripper closed"));
  // A stop, a new engagement, and other programs: nothing of it lets go.
  order("stop: true");
  order("reset: true");
  EXPECT_EQ(status().gripper(), "closed");
  order("engage: true");
  at_rest();
  EXPECT_EQ(status().gripper(), "closed");
  slave->kill();
  start_slave();
  ASSERT_TRUE(is("closed")) << "read back by a slave that was told nothing";
  master->kill();
  client.close();
  start_master();
  ASSERT_TRUE(is("closed"));
  order("engage: true");
  EXPECT_EQ(status().gripper(), "closed");
  EXPECT_EQ(handrail({"robot", "release"}).first, 0);
  EXPECT_EQ(status().gripper(), "open");
}

}  // namespace
}  // namespace handrail
