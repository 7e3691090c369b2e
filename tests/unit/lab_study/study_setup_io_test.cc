#include "server/lab/study/study_setup_io.h"

#include <gtest/gtest.h>

#include "server/base/units.h"

namespace handrail {
namespace {

Result<StudySetup> with(const std::vector<std::string>& settings) {
  return study_setup("linear-movement", "linear-movement", settings);
}

void expect_error(const std::vector<std::string>& settings, const std::string& start,
                  const std::string& part) {
  const auto result = with(settings);
  ASSERT_FALSE(result) << settings[0];
  EXPECT_EQ(result.message().rfind(start, 0), 0u) << result.message();
  EXPECT_NE(result.message().find(part), std::string::npos) << result.message();
}

TEST(StudySetup, SetsFieldsOfSceneRigOperatorHapticsAndLink) {
  const auto setup = with({"guidance.delta_mm=1", "smoother.form=LOW_LAG", "rig.servo_spread=0.1",
                           "operator.speed_mm_s=60", "haptic.rate_hz=500", "link.delay_ms=20"});
  ASSERT_TRUE(setup) << setup.message();
  EXPECT_DOUBLE_EQ(setup->machine.scene.guidance.delta, 1.0 * kMm);
  EXPECT_DOUBLE_EQ(setup->machine.rig.controller.arm.spread, 0.1);
  EXPECT_DOUBLE_EQ(setup->population.median().speed, 60.0 * kMm);
  EXPECT_EQ(setup->machine.tick, 2 * kMillisecond);
  EXPECT_EQ(setup->machine.transit, 20 * kMillisecond);
  EXPECT_EQ(setup->machine.scene.smoother_samples, 53) << "105 at 1 kHz last as long as 53 here";
}

TEST(StudySetup, ADeviceThatTurnsTheStylusIsAskedFor) {
  for (const auto& [value, turns] : {std::pair("true", true), std::pair("false", false)}) {
    const auto setup = with({std::string("haptic.torque=") + value});
    ASSERT_TRUE(setup) << setup.message();
    const LinearTask& task = *setup->machine.scene.task;
    const auto cell = study_cell(setup->machine, {task.p_SA, task.q_first}, "task.a_mm", 1, 1);
    ASSERT_TRUE(cell) << cell.message();
    EXPECT_EQ((*cell)->haptic.has_torque, turns);
  }
  EXPECT_FALSE(with({})->machine.torque) << "as in the dissertation";
}

TEST(StudySetup, AMedianOutsideThePopulationsBoundsWidensThem) {
  const auto setup = with({"operator.pause_s=30"});
  ASSERT_TRUE(setup) << setup.message();
  EXPECT_DOUBLE_EQ(setup->population.median().pause, 30.0);
  Population population = setup->population;
  EXPECT_DOUBLE_EQ(population.find("pause_s")->high, 30.0);
}

TEST(StudySetup, ErrorsNameTheSettingAndWhatWasExpected) {
  expect_error({"guidance.delta_mm=abc"}, "--set guidance.delta_mm=abc: ", "number");
  expect_error({"operator.sped_mm_s=1"}, "--set operator.sped_mm_s=1: ", "'speed_mm_s'");
  expect_error({"operator.speed_mm_s=fast"}, "--set operator.speed_mm_s=fast: ", "number");
  expect_error({"operator.speed_mm_s=-4"}, "--set operator.speed_mm_s=-4: ", "outside");
  expect_error({"haptic.rate_hz=20"}, "--set haptic.rate_hz=20: ", "100 to 5000 Hz");
  expect_error({"haptic.torque=yes"}, "--set haptic.torque=yes: ", "true or false");
  expect_error({"haptic.speed=20"}, "--set haptic.speed=20: ", "haptic.rate_hz");
  expect_error({"link.delay_ms=900"}, "--set link.delay_ms=900: ", "0 to 200 ms");
  expect_error({"smoother.form=LENGTH", "smoother.samples=900", "haptic.rate_hz=5000"},
               "--set haptic.rate_hz=5000: ", "at most 1000");
  expect_error({"rig.servo_lag_ms=500"}, "--set rig.servo_lag_ms=500: ", "30 to 60");
  expect_error({"rig.seed=7"}, "--set rig.seed=7: ", "sets this itself");
  expect_error({"nonsense"}, "", "KEY=VALUE");
}

TEST(StudySetup, SaysWhenSceneOrPopulationIsMissing) {
  EXPECT_NE(study_setup("no-such-scene", "linear-movement", {}).message().find("no-such-scene"),
            std::string::npos);
  EXPECT_NE(study_setup("linear-movement", "no-such-people", {}).message().find("no-such-people"),
            std::string::npos);
}

}  // namespace
}  // namespace handrail
