// What each effect of a scene's rig does and costs.
#include "server/lab/scenes/effects.h"

#include <gmock/gmock.h>

#include "server/lab/scenes/explain.h"
#include "server/lab/scenes/explain_price.h"
#include "server/scene/scene_io.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

const std::atomic<bool> kGoOn = false;

const char kPress[] =
    "name: 'press' simulate { effect { arm_compliance { n_mm: 60 } }"
    " effect { plane { at_mm: [0, 0, 300] normal: [0, 0, 1] } } effect { sensor_noise {} } }";

Scene press() {
  const auto scene = parse_scene("/x/press.scene", kPress);
  EXPECT_TRUE(scene.is_ok()) << scene.message();
  return scene ? *scene : Scene();
}

TEST(Effects, LeavesEachOutInTurn) {
  const auto rows = effects_in_turn(press(), kGoOn);
  ASSERT_TRUE(rows) << rows.message();
  ASSERT_EQ(rows->rows.size(), 3u);
  EXPECT_EQ(rows->rows[0].left_out, "arm_compliance");
  EXPECT_GT(rows->rows[0].result.peak, 5.0 * rows->whole.peak) << "a rigid arm on a hard floor";
  EXPECT_EQ(rows->rows[1].left_out, "plane");
  EXPECT_EQ(rows->rows[1].result.peak, 0.0);
  EXPECT_EQ(rows->rows[2].left_out, "sensor_noise");
  EXPECT_EQ(rows->rows[2].result.peak, rows->whole.peak);
  EXPECT_GT(rows->whole.sensor_off, 100.0 * rows->rows[2].result.sensor_off);
  EXPECT_GT(rows->step_ns, 0.0);
}

TEST(Effects, NamesTheSecondOfAKindAndTakesAThreadAlongWithItsSocket) {
  const auto scene = parse_scene(
      "/x/a.scene",
      "name: 'a' simulate { effect { plane { at_mm: [0, 0, 0] normal: [0, 0, 1] } }"
      " effect { screw_thread {} } effect { plane { at_mm: [0, 0, 1] normal: [0, 0, 1] } }"
      " effect { hex_socket { at_mm: [400, 0, 250] axis: [0, 0, 1] } } }");
  ASSERT_TRUE(scene) << scene.message();
  const auto rigs = rigs_without_each(*scene);
  ASSERT_EQ(rigs.size(), 4u);
  EXPECT_EQ(rigs[0].left_out, "plane");
  EXPECT_EQ(rigs[2].left_out, "plane 2");
  EXPECT_EQ(rigs[3].left_out, "hex_socket");
  EXPECT_EQ(rigs[3].scene.simulate->effects.size(), 2u);
  EXPECT_EQ(rigs[3].scene.simulate->find<ScrewThreadSpec>(), nullptr);
  EXPECT_EQ(rigs[2].scene.simulate->effects.size(), 3u);
}

TEST(Effects, AreWrittenForPeopleAndPrograms) {
  EffectRows rows;
  rows.scene = "press";
  rows.whole.peak = 57.0;
  rows.rows.push_back({"plane", PressResult(), 12.0});
  EXPECT_THAT(effects_json(rows), HasSubstr("\"without\": [{\"effect\": \"plane\""));
  EXPECT_THAT(effects_json(rows), HasSubstr("\"peak_force_n\": 57"));
  EXPECT_THAT(effects_table(rows), HasSubstr("57.00"));
}

TEST(Effects, ASceneOfWallsHasNoArm) {
  const auto scene = SceneLibrary().load("gearshift");
  ASSERT_TRUE(scene) << scene.message();
  EXPECT_THAT(effects_in_turn(*scene, kGoOn).message(), HasSubstr("no arm takes part"));
}

TEST(ExplainScene, CoversTheRigsSideOfAScene) {
  const auto said = explain_scene(press(), kGoOn);
  ASSERT_TRUE(said) << said.message();
  std::vector<std::string> last;
  for (const PricedEffect& effect : said->effects) {
    if (effect.on_rig) last.push_back(effect.name);
  }
  ASSERT_GE(last.size(), 3u);
  last.erase(last.begin(), last.end() - 3);
  EXPECT_THAT(last, ElementsAre("arm_compliance", "plane", "sensor_noise"));
  EXPECT_THAT(said->not_simulated, Contains("servo_lag"));
  EXPECT_THAT(said->not_simulated, Not(Contains("contact with a workpiece")));
}

TEST(ExplainScene, SaysWhatTheArmCannotReach) {
  const auto scene = parse_scene(
      "/x/a.scene",
      "name: 'a' simulate { effect { plane { at_mm: [0, 0, -2000] normal: [0, 0, 1] } } }");
  ASSERT_TRUE(scene);
  EXPECT_THAT(explain_scene(*scene, kGoOn).message(), HasSubstr("cannot reach plane"));
}

}  // namespace
}  // namespace handrail
