#include "server/model/scene.h"

#include <gtest/gtest.h>

#include <functional>

namespace handrail {
namespace {

TEST(SectionHashes, AToolThatIsOrPointsElsewhereIsAnother) {
  Scene one, aside, turned;
  one.X_AT = Pose{Vec3(0.01, 0, 0), Quat(1, 0, 0, 0)};
  aside.X_AT = Pose{Vec3(0.02, 0, 0), Quat(1, 0, 0, 0)};
  turned.X_AT = Pose{Vec3(0.01, 0, 0), Quat(0, 1, 0, 0)};
  EXPECT_NE(section_hashes(one).robot, section_hashes(aside).robot);
  EXPECT_NE(section_hashes(one).robot, section_hashes(turned).robot);
}

TEST(SectionHashes, ChangeWithTheirOwnSectionOnly) {
  const SectionHashes base = section_hashes(Scene());
  const struct {
    std::function<void(Scene&)> change;
    bool mapping, limits, robot;
  } cases[] = {
      {[](Scene& s) { s.mapping.scale = 1.0; }, true, false, false},
      {[](Scene& s) { s.mapping.R_SM = Mat3::Identity(); }, true, false, false},
      {[](Scene& s) { s.guidance.catch_up = 0.05; }, true, false, false},
      {[](Scene& s) { s.guidance.catch_up_rotation = 0.2; }, true, false, false},
      {[](Scene& s) { s.guidance.tool_reach = 0.1; }, false, false, false},
      {[](Scene& s) { s.guidance.local_surface = true; }, false, false, false},
      {[](Scene& s) { s.limits.joints.lower[5] = -1.0; }, false, true, false},
      {[](Scene& s) { s.limits.joints.upper[0] = 1.0; }, false, true, false},
      {[](Scene& s) { s.limits.joints.max_speed[3] = 1.0; }, false, true, false},
      {[](Scene& s) { s.limits.joints.max_acceleration[2] = 1.0; }, false, true, false},
      {[](Scene& s) { s.limits.joints.max_jerk[4] = 1.0; }, false, true, false},
      {[](Scene& s) { s.limits.tip_speed = 0.25; }, false, true, false},
      {[](Scene& s) { s.limits.workspace_low[2] = 0.0; }, false, true, false},
      {[](Scene& s) { s.limits.workspace_high[0] = 0.5; }, false, true, false},
      {[](Scene& s) { s.bumper.enabled = false; }, false, true, false},
      {[](Scene& s) { s.bumper.alpha = 2e-5; }, false, true, false},
      {[](Scene& s) { s.bumper.threshold = 40.0; }, false, true, false},
      {[](Scene& s) { s.bumper.dead_band = 1.0; }, false, true, false},
      {[](Scene& s) { s.bumper.form = BumperSettings::Form::kPublished; }, false, true, false},
      {[](Scene& s) { s.bumper.contact = 9.0; }, false, true, false},
      {[](Scene& s) { s.bumper.friction = 0.2; }, false, true, false},
      {[](Scene& s) { s.bumper.noise = 1.0; }, false, true, false},
      {[](Scene& s) { s.bumper.promise = 200.0; }, false, true, false},
      {[](Scene& s) { s.bumper.stiffest = 30e3; }, false, true, false},
      {[](Scene& s) { s.bumper.sensor_lag = 0.002; }, false, true, false},
      {[](Scene& s) { s.tip_length = 0.085; }, false, false, true},
      {[](Scene& s) { s.X_AT.emplace(); }, false, false, true},
      {[](Scene& s) { s.description = "other"; }, false, false, false},
      {[](Scene& s) { s.guidance.stiffness = 1.0; }, false, false, false},
      {[](Scene& s) { s.task.emplace(); }, false, false, false},
  };
  for (const auto& c : cases) {
    Scene scene;
    c.change(scene);
    const SectionHashes h = section_hashes(scene);
    EXPECT_EQ(h.mapping != base.mapping, c.mapping);
    EXPECT_EQ(h.limits != base.limits, c.limits);
    EXPECT_EQ(h.robot != base.robot, c.robot);
  }
}

TEST(Warnings, AreSilentAtTheDefaultsAndSpeakOfBumperAndStiffness) {
  Scene scene;
  EXPECT_TRUE(warnings_of(scene).empty());
  scene.bumper.alpha = 5e-5;
  EXPECT_TRUE(warnings_of(scene).empty());  // only the published form swings by it
  scene.bumper.form = BumperSettings::Form::kPublished;
  scene.guidance.stiffness = 2000.0;
  ASSERT_EQ(warnings_of(scene).size(), 2U);
  EXPECT_TRUE(warnings_of(scene)[0].starts_with("bumper.alpha_mm_n"));
  EXPECT_TRUE(warnings_of(scene)[1].starts_with("guidance.stiffness_n_mm"));
}

TEST(Warnings, SayThatWallsWithoutTheirEffectAreNotFelt) {
  Scene scene;
  scene.walls = std::make_shared<Walls>();
  ASSERT_EQ(warnings_of(scene).size(), 1U);
  EXPECT_TRUE(warnings_of(scene)[0].starts_with("effect: "));
  scene.effects.push_back({});
  ASSERT_EQ(scene.effects[0].kind, EffectKind::kWall);
  EXPECT_TRUE(warnings_of(scene).empty());
}

TEST(SceneName, IsSafeAsAFilesName) {
  EXPECT_TRUE(is_scene_name("linear-movement_2"));
  EXPECT_TRUE(is_scene_name(std::string(47, 'a')));
  for (const std::string& bad : {std::string(), std::string(48, 'a'), std::string("../x"),
                                 std::string("a/b"), std::string("a.b"), std::string("a\0b", 3)}) {
    EXPECT_FALSE(is_scene_name(bad)) << bad;
  }
}

}  // namespace
}  // namespace handrail
