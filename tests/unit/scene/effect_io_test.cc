#include "server/scene/effect_io.h"

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include "proto/scene.pb.h"
#include "server/scene/scene_io.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

std::vector<EffectSpec> effects_of(const std::string& text, std::string* problem = nullptr) {
  pb::Scene scene;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &scene)) << text;
  std::vector<EffectSpec> out;
  const auto found = effects_from(scene.effect(), out);
  if (problem != nullptr) {
    *problem = found ? found->path + ": " + found->text : "";
  } else {
    EXPECT_FALSE(found.has_value()) << found->path << ": " << found->text;
  }
  return out;
}

std::string complaint(const std::string& text) {
  std::string problem;
  effects_of(text, &problem);
  return problem;
}

TEST(EffectIo, ConvertsToSi) {
  const auto e = effects_of(
      "effect { wall {} } effect { progressive { c: 15 centre_mm: [1, -2] clockwise: false } }"
      "effect { detent { place { name: '1' at_mm: [-20, 30] } place { name: 'R' at_mm: [20, -30] }"
      "  radius_mm: 4 peak_n: 5 } }"
      "effect { return_spring { stiffness_n_mm: 0.2 peak_n: 3 home_mm: 2 } }"
      "effect { coulomb { force_n: 0.5 } } effect { viscous { coupling_n_mm: 3 } }"
      "effect { one_way { stiffness_n_mm: 4 } }");
  ASSERT_EQ(e.size(), 7u);
  EXPECT_EQ(e[0].kind, EffectKind::kWall);
  EXPECT_EQ(e[1].kind, EffectKind::kProgressive);
  EXPECT_EQ(e[1].c, 15.0);
  EXPECT_TRUE(e[1].at.isApprox(Vec2(0.001, -0.002)));
  EXPECT_FALSE(e[1].clockwise);
  EXPECT_EQ(e[1].coupling, 2500.0);
  EXPECT_EQ(e[2].kind, EffectKind::kDetent);
  ASSERT_EQ(e[2].places.size(), 2u);
  EXPECT_TRUE(e[2].places[1].isApprox(Vec2(0.02, -0.03)));
  EXPECT_EQ(e[2].place_names[1], "R");
  EXPECT_DOUBLE_EQ(e[2].radius, 0.004);
  EXPECT_EQ(e[2].peak, 5.0);
  EXPECT_EQ(e[3].kind, EffectKind::kReturn);
  EXPECT_DOUBLE_EQ(e[3].stiffness, 200.0);
  EXPECT_EQ(e[3].peak, 3.0);
  EXPECT_DOUBLE_EQ(e[3].radius, 0.002);
  EXPECT_EQ(e[4].kind, EffectKind::kCoulomb);
  EXPECT_EQ(e[4].peak, 0.5);
  EXPECT_EQ(e[5].kind, EffectKind::kViscous);
  EXPECT_EQ(e[5].coupling, 3000.0);
  EXPECT_EQ(e[6].kind, EffectKind::kOneWay);
  EXPECT_EQ(e[6].stiffness, 4000.0);
}

// A field that the reader does not know would be left out in silence.
TEST(EffectIo, EveryFieldOfEveryEffectIsRead) {
  const auto& all = *pb::Effect::descriptor();
  ASSERT_EQ(all.field_count(), static_cast<int>(EffectKind::kCount));
  for (int i = 0; i < all.field_count(); ++i) {
    google::protobuf::RepeatedPtrField<pb::Effect> list;
    pb::Effect& effect = *list.Add();
    effect.GetReflection()->MutableMessage(&effect, all.field(i));
    std::vector<EffectSpec> out;
    const auto problem = effects_from(list, out, true);
    ASSERT_FALSE(problem) << all.field(i)->name() << ": " << problem->path;
    EXPECT_EQ(name_of(out.at(0).kind), all.field(i)->name());
  }
}

TEST(EffectIo, DeviceEffectsAreThoseListed) {
  const DeviceEffects some =
      device_effects(effects_of("effect { device_inertia {} } effect { device_quantisation {} }"));
  EXPECT_TRUE(some.inertia);
  EXPECT_FALSE(some.friction);
  EXPECT_TRUE(some.quantisation);
  EXPECT_FALSE(some.force_limits);
  const DeviceEffects others =
      device_effects(effects_of("effect { device_friction {} } effect { device_force_limits {} }"));
  EXPECT_FALSE(others.inertia);
  EXPECT_TRUE(others.friction);
  EXPECT_FALSE(others.quantisation);
  EXPECT_TRUE(others.force_limits);
}

TEST(EffectIo, RefusesAnEntryThatIsNotExactlyOneEffect) {
  EXPECT_EQ(complaint("effect {}"), "effect[0]: 0 effects in one entry, expected exactly 1");
  EXPECT_EQ(complaint("effect { wall {} viscous {} }"),
            "effect[0]: 2 effects in one entry, expected exactly 1");
}

TEST(EffectIo, RefusesAKindTwice) {
  EXPECT_EQ(complaint("effect { wall {} } effect { wall {} }"), "effect[1]: wall is listed twice");
}

TEST(EffectIo, RefusesDetentsThatOverlapOrAreNone) {
  EXPECT_THAT(complaint("effect { detent {} }"), HasSubstr("effect[0].detent.place: 0 places"));
  EXPECT_EQ(
      complaint("effect { detent { place { name: '1' at_mm: [0, 0] }"
                " place { name: '2' at_mm: [6, 0] } radius_mm: 4 } }"),
      "effect[0].detent.place[1].at_mm: 6 mm from '1', expected at least twice the radius, 8");
}

TEST(EffectIo, ASceneWithoutWallsHasNoUseForEffects) {
  const auto scene = parse_scene("/x/bare.scene", "name: \"bare\"\neffect { wall {} }\n");
  ASSERT_FALSE(scene.is_ok());
  EXPECT_THAT(scene.message(), HasSubstr("effects need walls"));
  EXPECT_THAT(scene.message(), HasSubstr("/x/bare.scene:2"));
}

TEST(EffectIo, AFieldOutOfRangeNamesItself) {
  const auto scene =
      parse_scene("/x/bare.scene", "name: \"bare\"\neffect { coulomb { force_n: 80 } }\n");
  EXPECT_THAT(scene.message(), HasSubstr("effect[0].coulomb.force_n"));
  EXPECT_THAT(scene.message(), HasSubstr("80 is outside 0 to 50 N"));
}

}  // namespace
}  // namespace handrail
