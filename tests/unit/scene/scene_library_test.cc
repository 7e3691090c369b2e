#include "server/scene/scene_library.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "server/base/units.h"
#include "server/kinematics/rv2a.h"
#include "tests/support/arm_samples.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

// But for the one that is without protection on purpose: it says so.
TEST(SceneLibrary, ShipsScenesThatAllLoadWithoutWarning) {
  const SceneLibrary library;
  const auto entries = library.list();
  EXPECT_GE(entries.size(), 3U);
  for (const auto& [name, file] : entries) {
    const Result<Scene> scene = library.load(name);
    ASSERT_TRUE(scene.is_ok()) << scene.message();
    EXPECT_EQ(scene->name, name);
    EXPECT_FALSE(scene->description.empty()) << name;
    const std::vector<std::string> unprotected = {
        "bumper.enabled: false leaves contact unprotected"};
    EXPECT_EQ(warnings_of(*scene),
              name == "screw-fastening-nc" ? unprotected : std::vector<std::string>())
        << name;
  }
}

TEST(SceneLibrary, ShipsTheDefaultAndThePublishedMethods) {
  const SceneLibrary library;
  const Result<Scene> standard = library.load("linear-movement");
  ASSERT_TRUE(standard.is_ok()) << standard.message();
  EXPECT_FALSE(standard->guidance.published_method);
  EXPECT_EQ(standard->smoother_samples, 200);
  const Result<Scene> published = library.load("published");
  ASSERT_TRUE(published.is_ok()) << published.message();
  EXPECT_TRUE(published->guidance.published_method);
  EXPECT_DOUBLE_EQ(published->guidance.delta, 1e-4);
  EXPECT_TRUE(published->guidance.chase);
  EXPECT_TRUE(published->mapping.absolute);
  EXPECT_EQ(published->smoother_samples, 200);
  EXPECT_EQ(published->bumper.form, BumperSettings::Form::kPublished);
  EXPECT_EQ(published->bumper.dead_band, 0.0);
  // The hand at the device's origin, turned as its frame, is the arm at home.
  const Pose home = forward(ArmGeometry(), test::joints_deg(0, 0, 90, 0, 90, 0));
  EXPECT_LT((published->mapping.tip_centre - home.p).norm(), 1e-9);
  EXPECT_LT(angle_between(LinearTask().q_first, home.q), 1e-9);
}

TEST(SceneLibrary, ShipsTheLinearMovementTask) {
  const Result<Scene> scene = SceneLibrary().load("linear-movement");
  ASSERT_TRUE(scene.is_ok() && scene->task.has_value()) << scene.message();
  const LinearTask& task = *scene->task;
  // 75 mm to the side and 75 mm down, 150 mm in all as in the dissertation.
  EXPECT_TRUE((task.p_SB - task.p_SA).isApprox(Vec3(0, -0.075, 0), 1e-12));
  EXPECT_TRUE((task.p_SC - task.p_SB).isApprox(Vec3(0, 0, -0.075), 1e-12));
  EXPECT_TRUE(task.turn.isApprox(Vec3(45 * kDeg, 0, 0), 1e-12));
}

TEST(SceneLibrary, LooksInTheFoldersGivenFirst) {
  const TempFolder folder;
  const std::string mine =
      folder.write("linear-movement.scene", "name: 'linear-movement' mapping { scale: 5 }");
  const SceneLibrary library({folder.path()});
  EXPECT_EQ(*library.find("linear-movement"), mine);
  EXPECT_EQ(library.load("linear-movement")->mapping.scale, 5.0);
  const auto entries = library.list();
  EXPECT_EQ(std::count_if(entries.begin(), entries.end(),
                          [](const auto& e) { return e.name == "linear-movement"; }),
            1);
}

TEST(SceneLibrary, LooksInTheFoldersOfTheEnvironment) {
  const TempFolder folder;
  folder.write("two/mine.scene", "name: 'mine'");
  const std::string path = folder.path() + "/one:" + folder.path() + "/two";
  ASSERT_EQ(::setenv("HANDRAIL_SCENE_PATH", path.c_str(), 1), 0);
  const SceneLibrary library;
  ::unsetenv("HANDRAIL_SCENE_PATH");
  EXPECT_EQ(*library.find("mine"), folder.path() + "/two/mine.scene");
}

TEST(SceneLibrary, LoadsWithOverrides) {
  const SceneLibrary library;
  const Result<Scene> scene = library.load("linear-movement", {{"mapping.scale", "5"}});
  ASSERT_TRUE(scene.is_ok()) << scene.message();
  EXPECT_EQ(scene->mapping.scale, 5.0);
  EXPECT_TRUE(scene->task.has_value());
  EXPECT_EQ(library.load("linear-movement", {{"mapping.scale", "50"}}).message(),
            "--set mapping.scale=50: 50 is outside 0.05 to 20");
}

TEST(SceneLibrary, SaysWhereItLooked) {
  const TempFolder folder;
  const std::string error = SceneLibrary({folder.path()}).find("none").message();
  EXPECT_TRUE(error.starts_with("scene 'none' not found in " + folder.path() + ", ")) << error;
}

TEST(SceneLibrary, NeverLeavesItsFolders) {
  const TempFolder folder;
  folder.write("secret.scene", "name: 'secret'");
  const SceneLibrary library({folder.path() + "/inner"});
  EXPECT_EQ(library.find("../secret").message(),
            "scene '../secret': expected 1 to 47 letters, digits, '-' and '_'");
}

}  // namespace
}  // namespace handrail
