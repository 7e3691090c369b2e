// How a scene says what its walls become as the task goes on.
#include "server/scene/wall_stages_io.h"

#include <gtest/gtest.h>

#include "server/base/units.h"
#include "server/scene/scene_io.h"

namespace handrail {
namespace {

const std::string kRoom =
    "region { name: 'road' kind: FREE viscosity_n_s_m: 3 }\n"
    "region { name: 'rim' kind: WALL stiffness_n_mm: 8 damping_n_s_mm: 0.002 }\n"
    "shape { disc { centre_mm: [0, 0] radius_mm: 40 region: 'road' } }\n";
const std::string kEffects =
    "effect { wall {} }\n"
    "effect { progressive { c: 5 } }\n"
    "effect { detent { place { name: 'left' at_mm: [-20, 0] } place { name: 'right' at_mm: [20, 0] "
    "}"
    " radius_mm: 4 peak_n: 3 } }\n";

Result<Scene> scene_of(const std::string& stages, const std::string& effects) {
  return parse_scene("/x/a.scene", "name: 'a'\nwalls {\n" + kRoom + stages + "}\n" + effects);
}
std::vector<WallStage> stages_of(const std::string& stages) {
  const Result<Scene> scene = scene_of(stages, kEffects);
  EXPECT_TRUE(scene.is_ok()) << scene.message();
  return scene ? scene->walls->stages : std::vector<WallStage>();
}
// Without the file's name and the place in it.
std::string stage_error_of(const std::string& stage, const std::string& effects = kEffects) {
  const std::string message = scene_of("stage { name: 'one' " + stage + " }\n", effects).message();
  const std::size_t field = message.find("field ");
  return field == std::string::npos ? message : message.substr(field);
}

TEST(WallStagesIo, WhatAStageDoesNotSayIsAsListed) {
  const auto stages = stages_of("stage { name: 'one' }\n");
  ASSERT_EQ(stages.size(), 1U);
  EXPECT_TRUE(stages[0].regions.empty());
  EXPECT_TRUE(stages[0].detent_peaks.empty());
  EXPECT_EQ(stages[0].when.kind, StageCondition::Kind::kNone);
}

TEST(WallStagesIo, AStageChangesWhatItNamesOfItsRegionsAndNothingElse) {
  const auto stages = stages_of(
      "stage { name: 'one' }\n"
      "stage { name: 'hard' region { name: 'rim' stiffness_n_mm: 12 }"
      " region { name: 'road' viscosity_n_s_m: 40 } }\n"
      "stage { name: 'dull' region { name: 'rim' damping_n_s_mm: 0.05 } }\n");
  ASSERT_EQ(stages.size(), 3U);
  EXPECT_TRUE(stages[0].regions.empty());
  ASSERT_EQ(stages[1].regions.size(), 2U);
  EXPECT_DOUBLE_EQ(stages[1].regions[1].stiffness, 12e3);
  EXPECT_DOUBLE_EQ(stages[1].regions[1].damping, 2.0);
  EXPECT_DOUBLE_EQ(stages[1].regions[0].viscosity, 40.0);
  EXPECT_DOUBLE_EQ(stages[2].regions[1].stiffness, 8e3);
  EXPECT_DOUBLE_EQ(stages[2].regions[1].damping, 50.0);
  EXPECT_DOUBLE_EQ(stages[2].regions[0].viscosity, 3.0);
}

TEST(WallStagesIo, AStageChangesTheDetentsThatItNames) {
  const auto stages = stages_of("stage { name: 'one' detent { place: 'right' peak_n: 0 } }\n");
  ASSERT_EQ(stages.size(), 1U);
  EXPECT_EQ(stages[0].detent_peaks, (std::vector<double>{3.0, 0.0}));
}

TEST(WallStagesIo, EveryConditionIsRead) {
  using Kind = StageCondition::Kind;
  const auto stages = stages_of(
      "stage { name: 'a' when { inside: 'road' } }\n"
      "stage { name: 'b' when { turned_over_deg: 180 } }\n"
      "stage { name: 'c' when { turned_under_deg: -90 } }\n"
      "stage { name: 'd' when { locked: 'right' } }\n"
      "stage { name: 'e' when { unlocked: 'left' } }\n");
  ASSERT_EQ(stages.size(), 5U);
  EXPECT_EQ(stages[0].when.kind, Kind::kInside);
  EXPECT_EQ(stages[0].when.index, 0);
  EXPECT_EQ(stages[1].when.kind, Kind::kTurnedOver);
  EXPECT_DOUBLE_EQ(stages[1].when.angle, 180.0 * kDeg);
  EXPECT_EQ(stages[2].when.kind, Kind::kTurnedUnder);
  EXPECT_DOUBLE_EQ(stages[2].when.angle, -90.0 * kDeg);
  EXPECT_EQ(stages[3].when.kind, Kind::kLocked);
  EXPECT_EQ(stages[3].when.index, 1);
  EXPECT_EQ(stages[4].when.kind, Kind::kUnlocked);
  EXPECT_EQ(stages[4].when.index, 0);
}

TEST(WallStagesIo, SaysWhereAndWhatIsWrong) {
  EXPECT_EQ(stage_error_of("region { name: 'rom' stiffness_n_mm: 2 }"),
            "field 'walls.stage[0].region[0].name': no region 'rom'; did you mean 'rim'?");
  EXPECT_EQ(stage_error_of("region { name: 'road' stiffness_n_mm: 2 }"),
            "field 'walls.stage[0].region[0].stiffness_n_mm': has no meaning for 'road', which is "
            "no WALL");
  EXPECT_EQ(stage_error_of("region { name: 'rim' viscosity_n_s_m: 2 }"),
            "field 'walls.stage[0].region[0].viscosity_n_s_m': has no meaning for 'rim', which is "
            "a WALL");
  EXPECT_EQ(stage_error_of("region { name: 'rim' stiffness_n_mm: 51 }"),
            "field 'walls.stage[0].region[0].stiffness_n_mm': 51 is outside 0.01 to 50 N/mm");
  EXPECT_EQ(stage_error_of("detent { place: 'rihgt' peak_n: 1 }"),
            "field 'walls.stage[0].detent[0].place': no place 'rihgt'; did you mean 'right'?");
  EXPECT_EQ(stage_error_of("detent { place: 'right' peak_n: 1 }", "effect { wall {} }\n"),
            "field 'walls.stage[0].detent[0].place': no effect is detent {}");
  EXPECT_EQ(stage_error_of("when { turned_over_deg: 1 }", "effect { wall {} }\n"),
            "field 'walls.stage[0].when.turned_over_deg': no effect is progressive {}");
  EXPECT_EQ(stage_error_of("when { inside: 'rim' }"),
            "field 'walls.stage[0].when.inside': 'rim' is a WALL");
  EXPECT_EQ(stage_error_of("when { inside: 'road' locked: 'left' }"),
            "field 'walls.stage[0].when': 2 conditions, expected one of inside, turned_over_deg, "
            "turned_under_deg, locked, unlocked");
  EXPECT_EQ(stage_error_of("when { }"),
            "field 'walls.stage[0].when': 0 conditions, expected one of inside, turned_over_deg, "
            "turned_under_deg, locked, unlocked");
}

TEST(WallStagesIo, ThereAreNoMoreThanABitForEach) {
  std::string stages;
  for (int i = 0; i < 64; ++i) stages += "stage { name: 's" + std::to_string(i) + "' }\n";
  EXPECT_EQ(stages_of(stages).size(), 64U);
  const std::string message = scene_of(stages + "stage { name: 'more' }\n", kEffects).message();
  EXPECT_NE(message.find("65 stages, expected at most 64"), std::string::npos) << message;
}

}  // namespace
}  // namespace handrail
