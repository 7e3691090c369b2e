// Tools that a scene names, and references of orientation tools.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/base/units.h"
#include "server/scene/scene_io.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

Result<Scene> named_scene(const std::string& text) {
  return parse_scene("named.scene", "name: 'named'\n" + text);
}
std::string named_complaint(const std::string& text) {
  const auto scene = named_scene(text);
  return scene ? "" : scene.message();
}

TEST(NamedTools, AreKeptApartFromThoseTheSceneCallsByItself) {
  const auto scene = named_scene(
      "tool { kind: N_ROTATION }\n"
      "tool { name: 'upright' kind: N_ROTATION turn_deg: [0, 0, 90] }\n"
      "tool { name: 'key-axis' kind: F_ROTATION axis: [0, 0, -2] tip_axis: [0, 0, 1] }\n"
      "tool { name: 'bore' kind: LINE at_mm: [350, 0, 300] direction: [0, 0, -1] }\n");
  ASSERT_TRUE(scene) << scene.message();
  ASSERT_EQ(scene->tools.size(), 1u);
  EXPECT_FALSE(has_reference(scene->tools[0]));
  ASSERT_EQ(scene->named_tools.size(), 3u);
  const ToolCall& upright = scene->named_tools[0].call;
  EXPECT_EQ(scene->named_tools[0].name, "upright");
  EXPECT_TRUE(has_reference(upright));
  // Straight down, turned a quarter about the vertical: still straight down.
  EXPECT_LT((upright.q_ref * Vec3::UnitZ() + Vec3::UnitZ()).norm(), 1e-12);
  EXPECT_LT((upright.q_ref * Vec3::UnitX() - Vec3(0, -1, 0)).norm(), 1e-12);
  const ToolCall& axis = scene->named_tools[1].call;
  EXPECT_TRUE(has_reference(axis));
  EXPECT_EQ(axis.axis_T, Vec3(Vec3::UnitZ()));
  EXPECT_FALSE(has_reference(scene->named_tools[2].call));
}

TEST(NamedTools, WhatIsWrongIsSaidWithPlaceAndValueAndWhatWasExpected) {
  EXPECT_THAT(
      named_complaint("tool { kind: N_ROTATION turn_deg: [0, 0, 90] }"),
      HasSubstr("'tool[0].name': missing, but a tool that turns the arm by itself is called "
                "by its name"));
  EXPECT_THAT(named_complaint("tool { kind: F_ROTATION axis: [0,0,1] tip_axis: [0,0,1] }"),
              HasSubstr("'tool[0].name': missing"));
  EXPECT_THAT(named_complaint("tool { name: 'a/b' kind: N_ROTATION }"),
              HasSubstr("'tool[0].name': 'a/b', expected 1 to 47 letters"));
  EXPECT_THAT(named_complaint("tool { name: 'a' kind: N_ROTATION }\n"
                              "tool { name: 'a' kind: POINT }"),
              HasSubstr("named.scene:3"));
  EXPECT_THAT(named_complaint("tool { name: 'a' kind: N_ROTATION }\n"
                              "tool { name: 'a' kind: POINT }"),
              HasSubstr("'tool[1].name': a second 'a', expected another name"));
  EXPECT_THAT(named_complaint("tool { name: 'a' kind: N_ROTATION turn_deg: [180, 1, 0] }"),
              HasSubstr("'tool[0].turn_deg': 180 deg long, expected at most 180"));
  EXPECT_THAT(named_complaint("tool { name: 'a' kind: N_ROTATION turn_deg: [90, 1] }"),
              HasSubstr("tool[0].turn_deg"));
  EXPECT_THAT(named_complaint("tool { name: 'a' kind: N_ROTATION turn_deg: [0, 0, 181] }"),
              HasSubstr("181 is outside -180 to 180 deg"));
  EXPECT_THAT(
      named_complaint("tool { name: 'a' kind: F_ROTATION axis: [0,0,1] tip_axis: [0,0,0] }"),
      HasSubstr("tool[0].tip_axis"));
  EXPECT_THAT(named_complaint("tool { name: 'a' kind: POINT turn_deg: [0, 0, 1] }"),
              HasSubstr("'tool[0].turn_deg': has no meaning for POINT"));
  EXPECT_THAT(named_complaint("tool { name: 'a' kind: N_ROTATION tip_axis: [0, 0, 1] }"),
              HasSubstr("'tool[0].tip_axis': has no meaning for N_ROTATION"));
  std::string many;
  for (int i = 0; i < 33; ++i) many += "tool { name: 'a" + std::to_string(i) + "' kind: POINT }\n";
  EXPECT_THAT(named_complaint(many), HasSubstr("the 32 that a scene may have"));
}

TEST(NamedTools, BothSidesMustHoldTheSame) {
  const auto hash = [](const std::string& text) {
    const auto scene = named_scene(text);
    EXPECT_TRUE(scene) << scene.message();
    return section_hashes(*scene).mapping;
  };
  const std::string one = "tool { name: 'a' kind: N_ROTATION turn_deg: [0, 0, 10] }";
  const std::uint64_t base = hash(one);
  EXPECT_EQ(base, hash(one));
  EXPECT_NE(base, hash(""));
  EXPECT_NE(base, hash("tool { name: 'b' kind: N_ROTATION turn_deg: [0, 0, 10] }"));
  EXPECT_NE(base, hash("tool { name: 'a' kind: N_ROTATION turn_deg: [0, 0, 11] }"));
  EXPECT_NE(base, hash("tool { name: 'a' kind: N_ROTATION }"));
  const std::string axis = "tool { name: 'a' kind: F_ROTATION axis: [0,0,1] tip_axis: ";
  EXPECT_NE(hash(axis + "[0,0,1] }"), hash(axis + "[0,1,0] }"));
  EXPECT_EQ(hash(""), hash("tool { kind: N_ROTATION }")) << "scenes without names hash as ever";
}

}  // namespace
}  // namespace handrail
