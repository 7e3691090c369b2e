#include <gtest/gtest.h>

#include <limits>

#include "devices/rig/rig_options_io.h"
#include "proto/config.pb.h"
#include "server/base/units.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

TEST(RigOptions, AnEmptyConfigurationGivesTheDocumentedDefaults) {
  const auto options = rig_options(pb::RigConfig{});
  ASSERT_TRUE(options) << options.message();
  EXPECT_DOUBLE_EQ(options->controller.arm.lag, 0.045);
  EXPECT_DOUBLE_EQ(options->controller.arm.spread, 0.03);
  EXPECT_DOUBLE_EQ(options->controller.arm.repeatability, 4e-5);
  EXPECT_TRUE(options->controller.arm.q_start.isApprox(ServoArmOptions::default_start()));
  EXPECT_EQ(options->controller.time_out_cycles, -1);
  EXPECT_EQ(options->controller.drop_share, 0.0);
  EXPECT_EQ(options->sensor.counts_per_n, 1e6);
  EXPECT_EQ(options->sensor.range_n, 1000.0);
  EXPECT_EQ(options->sensor.noise_n, 0.05);
}

TEST(RigOptions, ConvertsMillimetresDegreesAndMilliseconds) {
  pb::RigConfig config;
  config.set_repeatability_mm(0.1);
  config.set_drop_share(0.01);
  config.set_mxttout_cycles(12);
  for (const double lag : {30.0, 35.0, 40.0, 45.0, 50.0, 60.0}) config.add_joint_lag_ms(lag);
  for (const double q : {0.0, 20.0, 110.0, 0.0, 50.0, 0.0}) config.add_start_joints_deg(q);
  const auto options = rig_options(config);
  ASSERT_TRUE(options) << options.message();
  EXPECT_DOUBLE_EQ(options->controller.arm.repeatability, 1e-4);
  EXPECT_DOUBLE_EQ(options->controller.arm.joint_lag[5], 0.060);
  EXPECT_DOUBLE_EQ(options->controller.arm.q_start[2], 110.0 * kDeg);
  EXPECT_EQ(options->controller.time_out_cycles, 12);
  EXPECT_EQ(options->controller.drop_share, 0.01);
  EXPECT_EQ(options->sensor.drop_share, 0.01);
}

TEST(RigOptions, NamesAStartOutsideTheJointRanges) {
  pb::RigConfig config;
  for (const double q : {0.0, 0.0, 40.0, 0.0, 90.0, 0.0}) config.add_start_joints_deg(q);
  const auto options = rig_options(config);
  ASSERT_FALSE(options);
  EXPECT_NE(options.message().find("start_joints_deg: J3 = 40"), std::string::npos)
      << options.message();
}

TEST(RigOptions, NamesAListThatIsNotSixLong) {
  pb::RigConfig config;
  config.add_joint_lag_ms(45.0);
  const auto options = rig_options(config);
  ASSERT_FALSE(options);
  EXPECT_NE(options.message().find("joint_lag_ms: 1 values, expected 6"), std::string::npos)
      << options.message();
}

TEST(RigOptions, TakesOverrides) {
  const auto options = rig_options(std::vector<Override>{
      {"rig.servo_lag_ms", "50"}, {"rig.start_joints_deg", "0,20,110,0,50,0"}, {"rig.seed", "3"}});
  ASSERT_TRUE(options) << options.message();
  EXPECT_DOUBLE_EQ(options->controller.arm.lag, 0.050);
  EXPECT_DOUBLE_EQ(options->controller.arm.q_start[2], 110.0 * kDeg);
  EXPECT_EQ(options->controller.arm.seed, 3U);
  EXPECT_DOUBLE_EQ(rig_options(std::vector<Override>{})->controller.arm.lag, 0.045);
}

TEST(RigOptions, NamesAnOverrideThatTheRigCannotTake) {
  const auto error = [](const char* key, const char* value) {
    return rig_options(std::vector<Override>{{key, value}}).message();
  };
  EXPECT_EQ(error("rig.servo_lag_ms", "20"),
            "--set rig.servo_lag_ms=20: 20 is outside 30 to 60 ms");
  EXPECT_EQ(error("rig.servo_lag", "40"),
            "--set rig.servo_lag=40: no field 'servo_lag'; did you mean 'servo_lag_ms'?");
  EXPECT_EQ(error("servo_lag_ms", "40"), "--set servo_lag_ms=40: the key does not begin with rig.");
  EXPECT_EQ(error("rig.joint_lag_ms", "45,45"),
            "--set rig.joint_lag_ms=45,45: 2 values, expected 6");
  EXPECT_TRUE(
      error("rig.start_joints_deg", "0,0,40,0,90,0").starts_with("rig.start_joints_deg: J3 = 40"));
}

TEST(RigOptions, RunsWhatItsSceneListsAndNothingElse) {
  TempFolder folder;
  folder.write(
      "press.scene",
      "name: 'press' robot { tip_length_mm: 250 mount { offset_mm: [10, 0, 0] } } simulate {"
      " effect { servo_lag { lag_ms: 50 } } effect { sensor_drift { n: 2 } }"
      " effect { sensor_quantisation { n: 0.1 } }"
      " effect { plane { at_mm: [0, 0, 100] normal: [0, 0, 1] } } }");
  pb::RigConfig config;
  config.set_scene("press");
  config.add_scene_path(folder.path());
  const auto options = rig_options(config);
  ASSERT_TRUE(options) << options.message();
  EXPECT_DOUBLE_EQ(options->controller.arm.lag, 0.050);
  EXPECT_EQ(options->controller.arm.repeatability, 0.0);
  EXPECT_DOUBLE_EQ(options->controller.arm.geometry.d6, 0.250);
  ASSERT_TRUE(options->controller.arm.geometry.X_AT);
  EXPECT_DOUBLE_EQ(options->controller.arm.geometry.X_AT->p.x(), 0.010);
  EXPECT_EQ(options->sensor.noise_n, 0.0);
  EXPECT_EQ(options->sensor.drift_n, 2.0);
  EXPECT_EQ(options->sensor.step_n, 0.1);
  EXPECT_EQ(options->sensor.range_n, std::numeric_limits<double>::infinity());
  ASSERT_TRUE(options->world);
  EXPECT_NE(options->world->find<PlaneSpec>(), nullptr);
  config.set_scene("absent");
  const auto missing = rig_options(config);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.message().rfind("scene: ", 0), 0u) << missing.message();
}

}  // namespace
}  // namespace handrail
