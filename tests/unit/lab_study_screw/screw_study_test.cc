// The study of screw fastening with the trial itself.
#include "server/lab/study/screw/screw_study.h"

#include <gtest/gtest.h>

#include <map>

#include "server/lab/study/screw/screw_fit.h"
#include "server/lab/study/study_setup_io.h"

namespace handrail {
namespace {

StudySetup screw_setup() {
  auto out = study_setup("screw-fastening", "screw-fastening", {});
  EXPECT_TRUE(out) << out.message();
  return out ? std::move(*out) : StudySetup();
}

ScrewStudy run(const StudySetup& s, const ScrewStudyOptions& options) {
  auto out = run_screw_study(s.machine, s.population, options);
  EXPECT_TRUE(out) << out.message();
  return out ? std::move(*out) : ScrewStudy();
}

void expect_same(const ScrewStudyTrial& a, const ScrewStudyTrial& b) {
  EXPECT_EQ(a.mode, b.mode);
  EXPECT_EQ(a.result.end, b.result.end);
  EXPECT_EQ(a.result.completion_time, b.result.completion_time);
  EXPECT_EQ(a.result.measured.path, b.result.measured.path);
  EXPECT_EQ(a.result.measured.mean_force, b.result.measured.mean_force);
  EXPECT_EQ(a.result.measured.max_force, b.result.measured.max_force);
}

TEST(ScrewStudy, EveryOperatorIsMeasuredInAllModes) {
  ScrewStudyOptions options;
  options.operators = 1;
  options.trials = 1;
  const ScrewStudy study = run(screw_setup(), options);
  for (int i = 0; i < kScrewModes; ++i) {
    EXPECT_GE(study.count(static_cast<ScrewMode>(i)), 1) << i;
  }
  for (const ScrewStudyTrial& trial : study.trials) {
    EXPECT_GT(trial.result.completion_time, 0.0);
    EXPECT_LE(trial.result.measured.mean_force, trial.result.measured.max_force);
    EXPECT_LE(trial.result.measured.contact_time, trial.result.simulated_time);
  }
}

TEST(ScrewStudy, IsTheSameBitForBitOnAnyNumberOfThreads) {
  const StudySetup s = screw_setup();
  ScrewStudyOptions options;
  options.operators = 2;
  options.trials = 1;
  options.only = {static_cast<int>(ScrewMode::kCV)};
  options.threads = 1;
  const ScrewStudy one = run(s, options);
  options.threads = 2;
  const ScrewStudy two = run(s, options);
  ASSERT_EQ(one.trials.size(), two.trials.size());
  for (std::size_t i = 0; i < one.trials.size(); ++i) expect_same(one.trials[i], two.trials[i]);
}

TEST(ScrewStudy, TheFormOfTheBumperIsSeenInModesWithProtectionOnly) {
  const StudySetup s = screw_setup();
  ScrewStudyOptions options;
  options.operators = 1;
  options.trials = 1;
  options.only = {static_cast<int>(ScrewMode::kNCV), static_cast<int>(ScrewMode::kCV)};
  const ScrewStudy usual = run(s, options);
  options.bumper = BumperSettings::Form::kPublished;
  const ScrewStudy published = run(s, options);
  std::map<bool, bool> differs;
  for (int i = 0; i < kScrewModes; ++i) {
    const auto mode = static_cast<ScrewMode>(i);
    const auto force = [](const ScrewResult& result) { return result.measured.impulse; };
    differs[has_protection(mode)] |= usual.values(mode, force) != published.values(mode, force);
  }
  EXPECT_FALSE(differs[false]);
  EXPECT_TRUE(differs[true]);
}

// What is only used with tools or protection cannot change a fit that never runs them.
TEST(ScrewFit, TheFitNeverRunsAnotherMode) {
  StudySetup s = screw_setup();
  FitOptions options;
  options.operators = 1;
  options.evaluations = 1;
  const auto before = fit_screw(s.machine, s.population, options);
  ASSERT_TRUE(before) << before.message();
  for (const char* name : {"call_homing_ms", "call_key_ms"}) {
    ParameterRange* parameter = s.population.find(name);
    ASSERT_NE(parameter, nullptr);
    parameter->median = parameter->high;
  }
  s.machine.scene.guidance.stiffness *= 2.0;
  s.machine.scene.guidance.spring *= 2.0;
  s.machine.scene.bumper.threshold *= 2.0;
  s.machine.scene.bumper.form = BumperSettings::Form::kPublished;
  const auto after = fit_screw(s.machine, s.population, options);
  ASSERT_TRUE(after) << after.message();
  EXPECT_EQ(before->medians, after->medians);
  EXPECT_EQ(before->misfit, after->misfit);
  EXPECT_EQ(before->medians.size(), 3u) << "time, path and mean force";
}

}  // namespace
}  // namespace handrail
