// What a scene wants of the arm that it cannot reach is refused on loading.
#include "server/scene/workpiece_reach.h"

#include <gtest/gtest.h>

#include "server/base/units.h"
#include "server/kinematics/rv2a.h"
#include "server/scene/scene_io.h"

namespace handrail {
namespace {

Result<Scene> read_reach(const std::string& text) {
  return parse_scene("/x/a.scene", "name: 'a'\n" + text);
}
std::string reach_error_of(const std::string& text) { return read_reach(text).message(); }

// From line 2 on; the socket stands in line 3.
std::string socket(const std::string& at_mm, const std::string& axis = "0, 0, 1") {
  return "simulate { effect { screw_thread {} }\n effect { hex_socket { at_mm: [" + at_mm +
         "] axis: [" + axis + "] } } }\n";
}
std::string screw(const std::string& start_mm = "2, 1, 12") {
  return "screw { start_mm: [" + start_mm + "] }";
}

TEST(WorkpieceReach, ASocketTooFarAwayIsRefusedWithWhatTheArmNeeds) {
  // The wrist 301 mm above the bottom at (2000, 0, 255): shoulder at (100, 0, 350).
  EXPECT_EQ(reach_error_of(socket("2000, 0, 260")),
            "/x/a.scene:3:24: field 'simulate.effect[1].hex_socket.at_mm': out of the arm's reach: "
            "at the bottom of the socket the wrist would be 1911.1 mm from the shoulder, expected "
            "31.8 to 531.8 mm");
  EXPECT_EQ(reach_error_of(socket("350, 0, 260")), "");
}

TEST(WorkpieceReach, NeitherMayAJointLeaveItsRange) {
  EXPECT_EQ(reach_error_of("limits { joint_upper_deg: [20, 135, 170, 160, 120, 200] }" +
                           socket("0, 350, 260")),
            "/x/a.scene:3:24: field 'simulate.effect[1].hex_socket.at_mm': out of the arm's reach: "
            "at the bottom of the socket J1 would be at 90 deg, expected -160 to 20 deg");
  EXPECT_EQ(reach_error_of(socket("0, 350, 260")), "");
  // The socket looks down: the key would come from below.
  EXPECT_NE(reach_error_of(socket("350, 0, 100", "0, 0, -1")).find("at the bottom of the socket "),
            std::string::npos);
}

TEST(WorkpieceReach, NorTheTipItsWorkspace) {
  const std::string box = "limits { workspace_low_mm: [-2000, -2000, 258] }";
  EXPECT_EQ(reach_error_of(box + socket("350, 0, 260")),
            "/x/a.scene:3:24: field 'simulate.effect[1].hex_socket.at_mm': out of the arm's reach: "
            "at the bottom of the socket z would be 255 mm, expected the workspace's 258 to 2000 "
            "mm");
  EXPECT_EQ(reach_error_of(box + socket("350, 0, 264")), "");
}

TEST(WorkpieceReach, AScrewIsTurnedHalfATurnAndLeftClear) {
  EXPECT_EQ(reach_error_of(socket("350, 0, 260") + screw()), "");
  const std::string narrow = "limits { joint_lower_deg: [-160, -45, 50, -160, -120, -85] }";
  EXPECT_EQ(reach_error_of(narrow + socket("350, 0, 260")), "") << "nothing is turned";
  EXPECT_EQ(reach_error_of(narrow + socket("350, 0, 260") + screw()), "")
      << "another flat leaves room";
  const std::string held =
      "limits { joint_lower_deg: [-160, -45, 50, -160, -120, -85]\n"
      "joint_upper_deg: [160, 135, 170, 160, 120, 85] }";
  EXPECT_EQ(reach_error_of(held + socket("350, 0, 260")), "");
  const std::string error = reach_error_of(held + socket("350, 0, 260") + screw());
  EXPECT_NE(error.find("90 deg, expected -85 to 85 deg"), std::string::npos) << error;
  const std::string high = socket("450, 0, 400");
  EXPECT_EQ(reach_error_of(high + screw()), "");
  EXPECT_NE(reach_error_of(high + screw("2, 1, 200")).find("field 'screw.start_mm': out of"),
            std::string::npos);
  EXPECT_NE(reach_error_of(high + "screw { start_mm: [2, 1, 12] clear_mm: 200 }")
                .find("field 'screw.clear_mm': out of"),
            std::string::npos);
}

TEST(WorkpieceReach, TheHalfTurnAskedForCounts) {
  const Result<Scene> scene = read_reach(socket("350, 0, 260") + screw());
  ASSERT_TRUE(scene) << scene.message();
  EXPECT_FALSE(out_of_reach(*scene, 399 * kDeg));
  ASSERT_TRUE(out_of_reach(*scene, 401 * kDeg));
}

TEST(WorkpieceReach, TheKeyStandsInTheSocketWithRoomToTurnEitherWay) {
  for (const char* at : {"350, 0, 260", "0, 350, 260", "-250, 250, 260", "100, -350, 200"}) {
    const Result<Scene> scene = read_reach(socket(at) + screw());
    ASSERT_TRUE(scene) << scene.message();
    const Pose X_SK = scene->simulate->find<HexSocketSpec>()->X_SK;
    const Quat key = key_in_socket(*scene);
    EXPECT_LT((key * Vec3::UnitZ() + X_SK.q * Vec3::UnitZ()).norm(), 1e-9) << "straight";
    const Vec3 corner = X_SK.q.conjugate() * (key * Vec3::UnitX());
    EXPECT_NEAR(std::remainder(std::atan2(corner.y(), corner.x()), 60 * kDeg), 0.0, 1e-9) << at;
    JointVector q, seed;
    seed << std::atan2(X_SK.p.y(), X_SK.p.x()), 0.0, 90 * kDeg, 0.0, 90 * kDeg, 0.0;
    ASSERT_EQ(inverse_near(ArmGeometry(), {X_SK.p, key}, seed, q), InverseStatus::kOk);
    EXPECT_LE(std::abs(q[5]), 30 * kDeg + 1e-9) << at;
  }
}

TEST(WorkpieceReach, TheTasksPointsAreWithinReachTurnedAsTheyAreGoneTo) {
  const auto task = [](const char* a, const char* b, const char* c, const char* turn) {
    return std::string("task { a_mm: [") + a + "]\n b_mm: [" + b + "]\n c_mm: [" + c +
           "]\n turn_deg: [" + turn + "] }";
  };
  const char *near = "350, 0, 260", *aside = "350, 50, 260", *below = "350, 50, 200";
  EXPECT_EQ(reach_error_of(task(near, aside, below, "0, 0, 0")), "");
  EXPECT_EQ(reach_error_of(task("900, 0, 260", aside, below, "0, 0, 0")),
            "/x/a.scene:2:8: field 'task.a_mm': out of the arm's reach: the wrist would be 827.4 "
            "mm from the shoulder, expected 31.8 to 531.8 mm");
  EXPECT_NE(
      reach_error_of(task(near, "900, 0, 260", below, "0, 0, 0")).find("3:2: field 'task.b_mm'"),
      std::string::npos);
  EXPECT_NE(
      reach_error_of(task(near, aside, "900, 0, 260", "0, 0, 0")).find("4:2: field 'task.c_mm'"),
      std::string::npos);
  EXPECT_NE(
      reach_error_of(task(near, aside, below, "0, 150, 0")).find("5:2: field 'task.turn_deg'"),
      std::string::npos);
}

}  // namespace
}  // namespace handrail
