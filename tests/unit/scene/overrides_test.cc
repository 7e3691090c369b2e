#include "server/scene/overrides.h"

#include <gtest/gtest.h>

#include "proto/config.pb.h"
#include "proto/scene.pb.h"

namespace handrail {
namespace {

// The error of one override in a scene that is otherwise at its defaults.
std::string error_of(const std::string& key, const std::string& value) {
  pb::Scene scene;
  scene.set_name("a");
  return set_fields(scene, {{key, value}}).message();
}

TEST(Overrides, AreAKeyAndAValue) {
  const auto parsed = parse_overrides({"mapping.scale=2", "a=b=c", "limits.joint_lower_deg="});
  ASSERT_TRUE(parsed) << parsed.message();
  ASSERT_EQ(parsed->size(), 3U);
  EXPECT_EQ((*parsed)[0].key, "mapping.scale");
  EXPECT_EQ((*parsed)[0].value, "2");
  EXPECT_EQ((*parsed)[1].key, "a");
  EXPECT_EQ((*parsed)[1].value, "b=c");
  EXPECT_EQ((*parsed)[2].value, "");
  EXPECT_TRUE(parse_overrides({})->empty());
}

TEST(Overrides, RefusesAWordThatIsNoKeyAndValue) {
  EXPECT_EQ(parse_overrides({"a=1", "mapping.scale"}).message(),
            "--set mapping.scale: expected KEY=VALUE, such as guidance.stiffness_n_mm=0.4");
  EXPECT_EQ(parse_overrides({"=2"}).message(),
            "--set =2: expected KEY=VALUE, such as guidance.stiffness_n_mm=0.4");
}

TEST(SetFields, SetsEveryKindOfField) {
  pb::Scene scene;
  scene.set_name("a");
  const Status status = set_fields(scene, {{"description", "it's = \"free\" text"},
                                           {"mapping.scale", "-0"},
                                           {"mapping.scale", "1.5e0"},
                                           {"smoother.form", "LOW_LAG"},
                                           {"smoother.samples", "12"},
                                           {"bumper.enabled", "false"}});
  ASSERT_TRUE(status) << status.message();
  EXPECT_EQ(scene.description(), "it's = \"free\" text");
  EXPECT_EQ(scene.mapping().scale(), 1.5);
  EXPECT_EQ(scene.smoother().form(), pb::Smoother::LOW_LAG);
  EXPECT_EQ(scene.smoother().samples(), 12U);
  EXPECT_FALSE(scene.bumper().enabled());
}

TEST(SetFields, ReplacesAList) {
  pb::RigConfig rig;
  for (int i = 0; i < 6; ++i) rig.add_joint_lag_ms(45);
  ASSERT_TRUE(set_fields(rig, {{"joint_lag_ms", "31, 32,33.5,-0.034e-3, 35,36"},
                               {"joint_lag_ms", "31, 32,33.5,34, 35,36"}}));
  ASSERT_EQ(rig.joint_lag_ms_size(), 6);
  EXPECT_EQ(rig.joint_lag_ms(2), 33.5);
  EXPECT_EQ(rig.joint_lag_ms(4), 35.0);
  ASSERT_TRUE(set_fields(rig, {{"joint_lag_ms", ""}}));
  EXPECT_EQ(rig.joint_lag_ms_size(), 0);
  pb::MasterConfig master;
  ASSERT_TRUE(set_fields(master, {{"scene_path", "/a b,/c"}}));
  ASSERT_EQ(master.scene_path_size(), 2);
  EXPECT_EQ(master.scene_path(0), "/a b");
}

TEST(SetFields, TakesNegativeWholeNumbers) {
  pb::RigConfig rig;
  rig.set_mxttout_cycles(5);
  ASSERT_TRUE(set_fields(rig, {{"mxttout_cycles", "-1"}}));
  EXPECT_EQ(rig.mxttout_cycles(), -1);
}

TEST(SetFields, TakesThePrefixOffTheKey) {
  pb::RigConfig rig;
  ASSERT_TRUE(set_fields(rig, {{"rig.seed", "9"}}, "rig."));
  EXPECT_EQ(rig.seed(), 9U);
  EXPECT_EQ(set_fields(rig, {{"seed", "8"}}, "rig.").message(),
            "--set seed=8: the key does not begin with rig.");
  EXPECT_EQ(set_fields(rig, {{"rig.sede", "8"}}, "rig.").message(),
            "--set rig.sede=8: no field 'sede'; did you mean 'seed'?");
  EXPECT_EQ(set_fields(rig, {{"rig.servo_lag_ms", "61"}}, "rig.").message(),
            "--set rig.servo_lag_ms=61: 61 is outside 30 to 60 ms");
}

TEST(SetFields, RefusesAFieldThatDoesNotExist) {
  EXPECT_EQ(error_of("guidance.stifness_n_mm", "1"),
            "--set guidance.stifness_n_mm=1: no field 'guidance.stifness_n_mm'; did you mean "
            "'guidance.stiffness_n_mm'?");
  EXPECT_EQ(error_of("guidence.delta_mm", "1"),
            "--set guidence.delta_mm=1: no field 'guidence'; did you mean 'guidance'?");
  EXPECT_EQ(error_of("robot.colour", "1"),
            "--set robot.colour=1: no field 'robot.colour'; expected one of tip_length_mm, mount");
  EXPECT_EQ(error_of("mapping.", "1"),
            "--set mapping.=1: no field 'mapping.'; expected one of scale, rotation, "
            "absolute, hand_centre_mm, tip_centre_mm");
}

TEST(SetFields, RefusesAKeyThatIsNotOneValue) {
  EXPECT_EQ(error_of("guidance", "1"),
            "--set guidance=1: 'guidance' is a block; name a field in it, such as guidance.method");
  EXPECT_EQ(error_of("tool.kind", "LINE"),
            "--set tool.kind=LINE: 'tool' is a list of blocks, which cannot be set here");
  EXPECT_EQ(error_of("mapping.scale.x", "1"),
            "--set mapping.scale.x=1: 'mapping.scale' is a value, nothing is inside it");
}

TEST(SetFields, RefusesAValueOfTheWrongKind) {
  EXPECT_EQ(error_of("guidance.delta_mm", "abc"),
            "--set guidance.delta_mm=abc: 'abc' is not a number");
  EXPECT_EQ(error_of("guidance.delta_mm", ""), "--set guidance.delta_mm=: '' is not a number");
  EXPECT_EQ(error_of("guidance.delta_mm", "1 mm"),
            "--set guidance.delta_mm=1 mm: '1 mm' is not a number");
  EXPECT_EQ(error_of("guidance.delta_mm", "1,2"),
            "--set guidance.delta_mm=1,2: '1,2' is not a number");
  EXPECT_EQ(error_of("smoother.form", "low"),
            "--set smoother.form=low: 'low' is not one of PUBLISHED, LOW_LAG, LENGTH");
  EXPECT_EQ(error_of("bumper.enabled", "maybe"),
            "--set bumper.enabled=maybe: 'maybe' is neither true nor false");
  EXPECT_EQ(error_of("smoother.samples", "-1"),
            "--set smoother.samples=-1: '-1' is not a whole number, 0 or more");
  EXPECT_EQ(error_of("mapping.rotation", "1,0,x"),
            "--set mapping.rotation=1,0,x: 'x' is not a number");
  pb::RigConfig rig;
  EXPECT_EQ(set_fields(rig, {{"mxttout_cycles", "1.5"}}).message(),
            "--set mxttout_cycles=1.5: '1.5' is not a whole number");
}

TEST(SetFields, RefusesAValueOutOfRange) {
  EXPECT_EQ(error_of("guidance.delta_mm", "11"),
            "--set guidance.delta_mm=11: 11 is outside 0.001 to 10 mm");
  EXPECT_EQ(error_of("guidance.delta_mm", "nan"),
            "--set guidance.delta_mm=nan: nan is not a finite number");
  EXPECT_EQ(error_of("limits.joint_lower_deg", "1,2"),
            "--set limits.joint_lower_deg=1,2: 2 values, expected 6");
  EXPECT_EQ(error_of("limits.joint_lower_deg", "1,2,3,4,5,201"),
            "--set limits.joint_lower_deg=1,2,3,4,5,201: 201 is outside -200 to 200 deg");
}

TEST(SetFields, LeavesTheMessageAloneOnAnError) {
  pb::Scene scene;
  scene.set_name("a");
  EXPECT_FALSE(set_fields(scene, {{"mapping.scale", "5"}, {"guidance.delta_mm", "abc"}}));
  EXPECT_FALSE(set_fields(scene, {{"mapping.scale", "5"}, {"guidance.delta_mm", "99"}}));
  EXPECT_FALSE(scene.has_mapping());
  EXPECT_FALSE(scene.has_guidance());
}

TEST(SetFields, BlamesTheOverrideThatTheProblemIsAt) {
  pb::Scene scene;
  scene.set_name("a");
  EXPECT_EQ(set_fields(scene, {{"limits.speed_share", "7"}, {"guidance.delta_mm", "99"}}).message(),
            "--set guidance.delta_mm=99: 99 is outside 0.001 to 10 mm");
  EXPECT_EQ(set_fields(scene, {{"mapping.scale", "99"}, {"mapping.scale", "98"}}).message(),
            "--set mapping.scale=98: 98 is outside 0.05 to 20");
  pb::RigConfig rig;  // one name begins like the other
  EXPECT_EQ(set_fields(rig, {{"counts_per_n_m", "0"}, {"counts_per_n", "5"}}).message(),
            "--set counts_per_n_m=0: 0 is outside 1 to 1000000000");
}

TEST(SetFields, BlamesTheOverrideSinceWhichACheckFails) {
  pb::Scene scene;
  scene.set_name("a");
  const auto at_most_four = [](const google::protobuf::Message& m) -> std::optional<FieldProblem> {
    const auto& s = static_cast<const pb::Scene&>(m);
    if (s.mapping().scale() + s.bumper().dead_band_n() <= 4.0) return std::nullopt;
    return FieldProblem{"elsewhere", "too much"};
  };
  const auto error = [&](const std::vector<Override>& overrides) {
    return set_fields(scene, overrides, "", at_most_four).message();
  };
  EXPECT_EQ(error({{"mapping.scale", "3"}, {"bumper.dead_band_n", "1"}}), "");
  scene.Clear();
  EXPECT_EQ(error({{"mapping.scale", "1"}, {"bumper.dead_band_n", "9"}, {"mapping.scale", "2"}}),
            "--set bumper.dead_band_n=9: field 'elsewhere': too much");
  EXPECT_EQ(error({{"mapping.scale", "9"}, {"mapping.scale", "1"}, {"bumper.dead_band_n", "8"}}),
            "--set bumper.dead_band_n=8: field 'elsewhere': too much");
}

}  // namespace
}  // namespace handrail
