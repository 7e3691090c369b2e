#include "server/scene/scene_io.h"

#include <gtest/gtest.h>

#include "server/base/units.h"
#include "server/kinematics/rv2a.h"

namespace handrail {
namespace {

std::string error_of(const std::string& text) {
  return parse_scene("/x/a.scene", "name: 'a'\n" + text).message();
}
Scene scene_of(const std::string& text) {
  const Result<Scene> scene = parse_scene("/x/a.scene", "name: 'a'\n" + text);
  EXPECT_TRUE(scene.is_ok()) << scene.message();
  return scene ? *scene : Scene();
}

TEST(SceneIo, DefaultsOfTheFileAndOfTheStructAgree) {
  const Scene read = scene_of("");
  const Scene made;
  EXPECT_EQ(read.mapping.scale, made.mapping.scale);
  EXPECT_EQ(read.mapping.R_SM, made.mapping.R_SM);
  EXPECT_EQ(read.guidance.published_method, made.guidance.published_method);
  EXPECT_DOUBLE_EQ(read.guidance.delta, made.guidance.delta);
  EXPECT_DOUBLE_EQ(read.guidance.stiffness, made.guidance.stiffness);
  EXPECT_DOUBLE_EQ(read.guidance.damping, made.guidance.damping);
  EXPECT_DOUBLE_EQ(read.guidance.torque_stiffness, made.guidance.torque_stiffness);
  EXPECT_DOUBLE_EQ(read.guidance.spring, made.guidance.spring);
  EXPECT_DOUBLE_EQ(read.guidance.catch_up, made.guidance.catch_up);
  EXPECT_DOUBLE_EQ(read.guidance.catch_up_rotation, made.guidance.catch_up_rotation);
  EXPECT_DOUBLE_EQ(read.guidance.tool_reach, made.guidance.tool_reach);
  EXPECT_EQ(read.guidance.local_surface, made.guidance.local_surface);
  EXPECT_EQ(read.smoother_samples, made.smoother_samples);
  EXPECT_EQ(read.bumper.enabled, made.bumper.enabled);
  EXPECT_DOUBLE_EQ(read.bumper.alpha, made.bumper.alpha);
  EXPECT_DOUBLE_EQ(read.bumper.threshold, made.bumper.threshold);
  EXPECT_DOUBLE_EQ(read.bumper.dead_band, made.bumper.dead_band);
  EXPECT_EQ(read.bumper.form, made.bumper.form);
  EXPECT_DOUBLE_EQ(read.bumper.contact, made.bumper.contact);
  EXPECT_DOUBLE_EQ(read.bumper.friction, made.bumper.friction);
  EXPECT_DOUBLE_EQ(read.bumper.noise, made.bumper.noise);
  EXPECT_DOUBLE_EQ(read.bumper.promise, made.bumper.promise);
  EXPECT_DOUBLE_EQ(read.bumper.stiffest, made.bumper.stiffest);
  EXPECT_DOUBLE_EQ(read.bumper.sensor_lag, made.bumper.sensor_lag);
  EXPECT_DOUBLE_EQ(read.limits.tip_speed, made.limits.tip_speed);
  EXPECT_DOUBLE_EQ(read.tip_length, made.tip_length);
  EXPECT_TRUE(read.tools.empty());
}

TEST(SceneIo, DefaultLimitsAreTheArms) {
  const Scene scene = scene_of("");
  const JointLimits& arm = rv2a_limits();
  EXPECT_EQ(scene.limits.joints.lower, arm.lower);
  EXPECT_EQ(scene.limits.joints.upper, arm.upper);
  EXPECT_EQ(scene.limits.joints.max_speed, arm.max_speed);
  EXPECT_TRUE(scene.limits.joints.max_acceleration.isApprox(arm.max_acceleration, 1e-12));
  EXPECT_TRUE(scene.limits.joints.max_jerk.isApprox(arm.max_jerk, 1e-12));
}

TEST(SceneIo, DefaultRotationTurnsRightUpAndTowardTheUser) {
  const Mat3 R = scene_of("").mapping.R_SM;
  EXPECT_EQ(R.col(0), Vec3(0, -1, 0));
  EXPECT_EQ(R.col(1), Vec3(0, 0, 1));
  EXPECT_EQ(R.col(2), Vec3(-1, 0, 0));
}

TEST(SceneIo, ConvertsUnits) {
  const Scene s = scene_of(
      "guidance { method: PUBLISHED delta_mm: 0.2 damping_n_s_mm: 0.002 catch_up_deg_s: 90\n"
      "catch_up_mm_s: 45 tool_reach_mm: 35 local_surface: true }\n"
      "bumper { alpha_mm_n: 0.02 } limits { speed_share: 0.5 tip_speed_mm_s: 250\n"
      "joint_acceleration_deg_s2: [90, 90, 90, 90, 90, 180] } robot { tip_length_mm: 85 }");
  EXPECT_TRUE(s.guidance.published_method);
  EXPECT_DOUBLE_EQ(s.guidance.delta, 2e-4);
  EXPECT_DOUBLE_EQ(s.guidance.damping, 2.0);
  EXPECT_DOUBLE_EQ(s.guidance.catch_up_rotation, 90 * kDeg);
  EXPECT_DOUBLE_EQ(s.guidance.catch_up, 0.045);
  EXPECT_DOUBLE_EQ(s.guidance.tool_reach, 0.035);
  EXPECT_TRUE(s.guidance.local_surface);
  EXPECT_DOUBLE_EQ(s.bumper.alpha, 2e-5);
  EXPECT_TRUE(s.limits.joints.max_speed.isApprox(0.5 * rv2a_limits().max_speed));
  EXPECT_DOUBLE_EQ(s.limits.tip_speed, 0.25);
  EXPECT_DOUBLE_EQ(s.limits.joints.max_acceleration[5], 180 * kDeg);
  EXPECT_DOUBLE_EQ(s.limits.joints.max_jerk[5], 9000 * kDeg);
  EXPECT_DOUBLE_EQ(s.tip_length, 0.085);
}

TEST(SceneIo, AToolMayBeMountedAsideAndTurned) {
  EXPECT_FALSE(scene_of("").X_AT);
  EXPECT_FALSE(scene_of("robot { mount { offset_mm: [0, 0, 0] } }").X_AT);
  const Scene s = scene_of("robot { mount { offset_mm: [40, -5, 25] turn_deg: [0, 90, 0] } }");
  ASSERT_TRUE(s.X_AT);
  EXPECT_LT((s.X_AT->p - Vec3(0.040, -0.005, 0.025)).norm(), 1e-15);
  EXPECT_LT((s.X_AT->q * Vec3::UnitZ() - Vec3::UnitX()).norm(), 1e-12);
  EXPECT_EQ(
      error_of("robot { tip_length_mm: 100 mount { offset_mm: [50, 0, -90] } }"),
      "/x/a.scene:2:36: field 'robot.mount.offset_mm': the tip would be 51 mm from the wrist's "
      "centre, expected at least 85");
  EXPECT_EQ(error_of("robot { mount { turn_deg: [120, 160, 0] } }"),
            "/x/a.scene:2:17: field 'robot.mount.turn_deg': 200 deg long, expected at most 180");
}

TEST(SceneIo, WantsTheNameOfTheFile) {
  EXPECT_EQ(parse_scene("/x/b.scene", "\nname: 'a'").message(),
            "/x/b.scene:2:1: field 'name': 'a' differs from the file's name 'b'");
  EXPECT_EQ(parse_scene("/x/a b.scene", "name: 'a b'").message(),
            "/x/a b.scene:1:1: field 'name': 'a b', expected 1 to 47 letters, digits, '-' and '_'");
}

TEST(SceneIo, RefusesAMatrixThatIsNoRotation) {
  EXPECT_EQ(error_of("mapping { rotation: [1, 0, 0, 0, 1, 0, 0, 0, -1] }"),
            "/x/a.scene:2:11: field 'mapping.rotation': determinant -1 mirrors, expected a "
            "rotation (+1)");
  EXPECT_EQ(error_of("mapping { rotation: [1, 0, 0, 0, 1, 0, 0, 0, 0.9] }"),
            "/x/a.scene:2:11: field 'mapping.rotation': columns are off unit length or right "
            "angles by 0.19");
}

TEST(SceneIo, RoundsARotationWrittenWithSevenDigitsToOne) {
  const Mat3 R = scene_of(
                     "mapping { rotation: [0.7071068, -0.7071068, 0, 0.7071068, 0.7071068, 0, "
                     "0, 0, 1] }")
                     .mapping.R_SM;
  EXPECT_LT((R * R.transpose() - Mat3::Identity()).norm(), 1e-14);
  EXPECT_NEAR(R(1, 0), 0.7071067811865476, 1e-7);
}

TEST(SceneIo, ChoosesTheSmoothersLength) {
  EXPECT_EQ(scene_of("smoother { form: LOW_LAG }").smoother_samples, 105);
  EXPECT_EQ(scene_of("smoother { form: LENGTH samples: 7 }").smoother_samples, 7);
  EXPECT_EQ(error_of("smoother { samples: 7 }"),
            "/x/a.scene:2:12: field 'smoother.samples': only used with form: LENGTH");
}

TEST(SceneIo, RefusesADeadBandThatSwallowsTheThreshold) {
  EXPECT_EQ(
      error_of("bumper { threshold_n: 5\ndead_band_n: 5 }"),
      "/x/a.scene:3:1: field 'bumper.dead_band_n': dead band 5 N is not below the threshold 5 "
      "N");
}

TEST(SceneIo, ReadsABumperWithItsPromise) {
  BumperSettings b = scene_of(
                         "bumper { form: PUBLISHED contact_n: 12 friction: 0.2 noise_n: 2 "
                         "sensor_lag_ms: 5 approach { force_n: 150 stiffness_n_mm: 30 } }")
                         .bumper;
  EXPECT_EQ(b.form, BumperSettings::Form::kPublished);
  EXPECT_DOUBLE_EQ(b.contact, 12.0);
  EXPECT_DOUBLE_EQ(b.friction, 0.2);
  EXPECT_DOUBLE_EQ(b.noise, 2.0);
  EXPECT_DOUBLE_EQ(b.sensor_lag, 5e-3);
  EXPECT_DOUBLE_EQ(b.promise, 150.0);
  EXPECT_DOUBLE_EQ(b.stiffest, 30e3);
  b = scene_of("bumper { approach {} threshold_n: 20 }").bumper;
  EXPECT_DOUBLE_EQ(b.promise, 200.0);
  EXPECT_DOUBLE_EQ(b.contact, 4.0);
}

TEST(SceneIo, RefusesABumperThatCannotTellContactFromNoiseOrKeepItsPromise) {
  EXPECT_EQ(error_of("bumper { contact_n: 50 }"),
            "/x/a.scene:2:10: field 'bumper.contact_n': 50 N is not below the threshold 50 N");
  EXPECT_EQ(
      error_of("bumper { noise_n: 3 }"),
      "/x/a.scene:2:10: field 'bumper.noise_n': a contact is felt at 10 N, which noise of 3 N "
      "reaches: expected at least 5 times as much");
  EXPECT_EQ(error_of("bumper { approach { force_n: 40 } }"),
            "/x/a.scene:2:21: field 'bumper.approach.force_n': 40 N is not above the threshold 50 "
            "N");
  EXPECT_EQ(error_of("bumper { threshold_n: -1 }"),
            "/x/a.scene:2:10: field 'bumper.threshold_n': -1 is outside 0.1 to 1000 N");
}

TEST(SceneIo, KeepsJointRangesWithinTheTable) {
  EXPECT_EQ(
      error_of("limits { joint_lower_deg: [-160, -45, 49, -160, -120, -200] }"),
      "/x/a.scene:2:10: field 'limits.joint_lower_deg[2]': 49 is below Table 3.1's 50 deg for "
      "J3");
  EXPECT_EQ(error_of("limits { joint_upper_deg: [161, 135, 170, 160, 120, 200] }"),
            "/x/a.scene:2:10: field 'limits.joint_upper_deg[0]': 161 is above Table 3.1's 160 deg "
            "for J1");
  EXPECT_EQ(error_of("limits { joint_upper_deg: [160, -45, 170, 160, 120, 200] }"),
            "/x/a.scene:2:10: field 'limits.joint_upper_deg[1]': J2 would range from -45 to -45 "
            "deg, expected lower below upper");
}

TEST(SceneIo, TakesAWorkspaceAndRefusesOneTooNarrow) {
  const Scene s = scene_of("limits { workspace_low_mm: [0, -400, 20] }");
  EXPECT_EQ(s.limits.workspace_low, Vec3(0.0, -0.4, 0.02));
  EXPECT_EQ(s.limits.workspace_high, Vec3(2.0, 2.0, 2.0));
  EXPECT_EQ(error_of("limits { workspace_low_mm: [0, 0, 20] workspace_high_mm: [500, 49, 500] }"),
            "/x/a.scene:2:39: field 'limits.workspace_high_mm[1]': the workspace would reach from "
            "0 to 49 mm along y, expected at least 50 mm");
}

TEST(SceneIo, TakesJerksOfItsOwnAndRefusesThoseOfAnArmThatCouldHardlyStop) {
  const Scene s = scene_of("limits { joint_jerk_deg_s3: [1e5, 1e5, 1e5, 1e5, 1e5, 2e5] }");
  EXPECT_DOUBLE_EQ(s.limits.joints.max_jerk[0], 1e5 * kDeg);
  EXPECT_DOUBLE_EQ(s.limits.joints.max_jerk[5], 2e5 * kDeg);
  EXPECT_EQ(error_of("limits { joint_jerk_deg_s3: [1e5, 12499, 1e5, 1e5, 1e5, 1e5] }"),
            "/x/a.scene:2:10: field 'limits.joint_jerk_deg_s3[1]': 12499 deg/s^3 is below 12500, "
            "with which full acceleration takes 80 ms");
}

TEST(SceneIo, TakesOnePositionAndOneOrientationTool) {
  const Scene s = scene_of("tool { kind: N_ROTATION } tool { kind: LINE direction: [0, 1, 0] }");
  ASSERT_EQ(s.tools.size(), 2U);
  EXPECT_EQ(s.tools[0].kind, ToolKind::kNRotation);
  EXPECT_EQ(s.tools[1].kind, ToolKind::kLine);
  EXPECT_EQ(error_of("tool { kind: POINT }\ntool { kind: PLANE normal: [0, 0, 1] }"),
            "/x/a.scene:3:1: field 'tool[1]': a second position tool, at most one can be active");
  EXPECT_EQ(
      error_of("tool { kind: N_ROTATION }\ntool { kind: F_ROTATION }"),
      "/x/a.scene:3:1: field 'tool[1]': a second orientation tool, at most one can be active");
}

TEST(SceneIo, PlacesAProblemOfATool) {
  EXPECT_EQ(error_of("tool {\n  kind: LINE\n  direction: [1, 0, 0]\n  at_mm: [0, 0, 0]\n  end_mm: "
                     "[-1, 0, 0]\n}"),
            "/x/a.scene:6:3: field 'tool[0].end_mm': the end point lies behind the start");
  EXPECT_EQ(error_of("tool {\n  kind: LINE\n  direction: [0, 0, 0]\n}"),
            "/x/a.scene:4:3: field 'tool[0].direction': the direction has no length");
}

const char* const kScrew =
    "simulate { effect { hex_socket { at_mm: [350, 0, 260] axis: [0, 0, 1] } }\n"
    " effect { screw_thread {} } }\n";

TEST(SceneIo, AScrewToFasten) {
  EXPECT_FALSE(scene_of("").screw.has_value());
  const Scene s =
      scene_of(std::string(kScrew) + "screw { start_mm: [2, 1, 12] tight_deg: 180 clear_mm: 8 }");
  ASSERT_TRUE(s.screw.has_value());
  EXPECT_TRUE(s.screw->start.isApprox(Vec3(2e-3, 1e-3, 12e-3), 1e-12));
  EXPECT_DOUBLE_EQ(s.screw->tight, 180 * kDeg);
  EXPECT_DOUBLE_EQ(s.screw->clear, 8e-3);
}

TEST(SceneIo, AScrewTaskNeedsAScrewAndAStartAboveIt) {
  EXPECT_EQ(error_of("screw { start_mm: [0, 0, 12] }"),
            "/x/a.scene:2:1: field 'screw': no screw to fasten: expected a hex_socket and a "
            "screw_thread in simulate");
  EXPECT_EQ(error_of(std::string(kScrew) + "screw { start_mm: [2, 0, -1] }"),
            "/x/a.scene:4:9: field 'screw.start_mm': not above the socket's rim");
  EXPECT_EQ(error_of(std::string(kScrew) + "screw { }"),
            "/x/a.scene:4:1: field 'screw.start_mm': missing, but required");
}

TEST(SceneIo, ReadsTheTask) {
  EXPECT_FALSE(scene_of("").task.has_value());
  const Scene s = scene_of(
      "task { a_mm: [350, 37.5, 329] b_mm: [350, -37.5, 329] c_mm: [350, -37.5, 254]\n"
      "turn_deg: [45, 0, -90] }");
  ASSERT_TRUE(s.task.has_value());
  EXPECT_TRUE(s.task->p_SA.isApprox(Vec3(0.35, 0.0375, 0.329), 1e-12));
  EXPECT_TRUE(s.task->p_SB.isApprox(Vec3(0.35, -0.0375, 0.329), 1e-12));
  EXPECT_TRUE(s.task->p_SC.isApprox(Vec3(0.35, -0.0375, 0.254), 1e-12));
  EXPECT_TRUE(s.task->turn.isApprox(Vec3(45 * kDeg, 0, -90 * kDeg), 1e-12));
}

TEST(SceneIo, WantsAWholeTask) {
  EXPECT_EQ(error_of("task {\n a_mm: [0, 0, 0] b_mm: [9, 0, 0] c_mm: [9, 9, 0] }"),
            "/x/a.scene:2:1: field 'task.turn_deg': missing, but required");
  EXPECT_EQ(error_of("task { b_mm: [9, 0, 0] c_mm: [9, 9, 0] turn_deg: [0, 0, 0] }"),
            "/x/a.scene:2:1: field 'task.a_mm': missing, but required");
  EXPECT_EQ(error_of("task { a_mm: [0, 0] }"),
            "/x/a.scene:2:8: field 'task.a_mm': 2 values, expected 3");
  EXPECT_EQ(error_of("task { a_mm: [0, 0, 2001] }"),
            "/x/a.scene:2:8: field 'task.a_mm[2]': 2001 is outside -2000 to 2000 mm");
  EXPECT_EQ(error_of("task { turn_deg: [0, 181, 0] }"),
            "/x/a.scene:2:8: field 'task.turn_deg[1]': 181 is outside -180 to 180 deg");
}

TEST(SceneIo, WantsTheTasksPointsApart) {
  const auto task = [](const char* a, const char* b, const char* c) {
    return std::string("task { a_mm: [") + a + "]\n b_mm: [" + b + "]\n c_mm: [" + c +
           "]\n turn_deg: [0, 0, 0] }";
  };
  EXPECT_EQ(error_of(task("0, 0, 0", "0, 0.5, 0", "0, 9, 0")),
            "/x/a.scene:3:2: field 'task.b_mm': 0.5 mm from a_mm, expected at least 1");
  EXPECT_EQ(error_of(task("0, 0, 0", "0, 9, 0", "0, 9, 0.3")),
            "/x/a.scene:4:2: field 'task.c_mm': 0.3 mm from b_mm, expected at least 1");
  EXPECT_EQ(error_of(task("0, 0, 0", "0, 9, 0", "0, 0, 0")),
            "/x/a.scene:4:2: field 'task.c_mm': 0 mm from a_mm, expected at least 1");
  EXPECT_EQ(error_of(task("350, 0, 260", "350, 1, 260", "350, 2, 260")), "");
}

// The error of a scene with `text` and overrides.
std::string error_with(const std::vector<Override>& overrides, const std::string& text = "") {
  return parse_scene("/x/a.scene", "name: 'a'\n" + text, nullptr, overrides).message();
}

TEST(SceneIo, TakesOverrides) {
  pb::Scene raw;
  const Result<Scene> scene = parse_scene("/x/a.scene", "name: 'a' mapping { scale: 3 }", &raw,
                                          {{"mapping.scale", "4"},
                                           {"guidance.method", "PUBLISHED"},
                                           {"smoother.form", "LENGTH"},
                                           {"smoother.samples", "7"},
                                           {"limits.speed_share", "0.5"},
                                           {"mapping.scale", "5"}});
  ASSERT_TRUE(scene.is_ok()) << scene.message();
  EXPECT_EQ(scene->mapping.scale, 5.0);
  EXPECT_TRUE(scene->guidance.published_method);
  EXPECT_EQ(scene->smoother_samples, 7);
  EXPECT_TRUE(scene->limits.joints.max_speed.isApprox(0.5 * rv2a_limits().max_speed));
  EXPECT_EQ(raw.mapping().scale(), 5.0);
}

TEST(SceneIo, KeepsWhatOverridesDoNotName) {
  const Result<Scene> scene = parse_scene("/x/a.scene", "name: 'a' tool { kind: POINT }", nullptr,
                                          {{"mapping.scale", "4"}, {"limits.speed_share", "1"}});
  ASSERT_TRUE(scene.is_ok()) << scene.message();
  EXPECT_EQ(scene->tools.size(), 1U);
  EXPECT_EQ(scene->name, "a");
}

TEST(SceneIo, TakesATaskFieldByField) {
  const std::vector<Override> task = {{"task.a_mm", "350,0,260"},
                                      {"task.b_mm", "350,9,260"},
                                      {"task.c_mm", "350,9,269"},
                                      {"task.turn_deg", "0,0,45"}};
  const Result<Scene> scene = parse_scene("/x/a.scene", "name: 'a'", nullptr, task);
  ASSERT_TRUE(scene.is_ok()) << scene.message();
  EXPECT_TRUE(scene->task->p_SC.isApprox(Vec3(0.35, 0.009, 0.269)));
  EXPECT_EQ(error_with({task[0]}),
            "--set task.a_mm=350,0,260: field 'task.b_mm': missing, but required");
}

TEST(SceneIo, NamesTheOverrideAtFault) {
  EXPECT_EQ(error_with({{"limits.speed_share", "0.5"}, {"guidance.delta_mm", "abc"}}),
            "--set guidance.delta_mm=abc: 'abc' is not a number");
  EXPECT_EQ(error_with({{"guidance.delta_mm", "11"}, {"limits.speed_share", "0.5"}}),
            "--set guidance.delta_mm=11: 11 is outside 0.001 to 10 mm");
  EXPECT_EQ(error_with({{"name", "b"}}), "--set name=b: 'b' differs from the file's name 'a'");
  // The dead band is what is wrong, but the threshold was set.
  EXPECT_EQ(
      error_with({{"bumper.threshold_n", "1"}, {"mapping.scale", "1"}},
                 "bumper { dead_band_n: 2 }"),
      "--set bumper.threshold_n=1: field 'bumper.dead_band_n': dead band 2 N is not below the "
      "threshold 1 N");
}

TEST(SceneIo, LooksAtOverridesTogether) {
  // Either alone would not do.
  EXPECT_EQ(error_with({{"bumper.threshold_n", "1"}, {"bumper.dead_band_n", "0.5"}}), "");
  EXPECT_EQ(error_with({{"smoother.samples", "7"}, {"smoother.form", "LENGTH"}}), "");
}

TEST(SceneIo, AnOverrideDoesNotMendAFile) {
  EXPECT_EQ(error_with({{"mapping.scale", "1"}}, "mapping { scale: 50 }"),
            "/x/a.scene:2:11: field 'mapping.scale': 50 is outside 0.05 to 20");
  EXPECT_EQ(error_with({{"smoother.form", "LENGTH"}}, "smoother { samples: 7 }"),
            "/x/a.scene:2:12: field 'smoother.samples': only used with form: LENGTH");
}

TEST(SceneIo, GivesTheMessageAsWritten) {
  pb::Scene raw;
  ASSERT_TRUE(parse_scene("/x/a.scene", "name: 'a'", &raw).is_ok());
  EXPECT_EQ(raw.name(), "a");
  EXPECT_FALSE(raw.has_mapping());
}

}  // namespace
}  // namespace handrail
