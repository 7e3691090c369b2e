#include "server/lab/study/linear/linear_study.h"

#include <gtest/gtest.h>

#include <set>

#include "server/lab/study/study_setup_io.h"

namespace handrail {
namespace {

StudySetup setup(const std::vector<std::string>& settings = {}) {
  auto out = study_setup("linear-movement", "linear-movement", settings);
  EXPECT_TRUE(out) << out.message();
  return out ? std::move(*out) : StudySetup();
}

LinearStudy run(const StudySetup& s, const StudyOptions& options) {
  auto out = run_linear_study(s.machine, s.population, options);
  EXPECT_TRUE(out) << out.message();
  return out ? std::move(*out) : LinearStudy();
}

void expect_same(const LinearStudyTrial& a, const LinearStudyTrial& b) {
  EXPECT_EQ(a.person, b.person);
  EXPECT_EQ(a.mode, b.mode);
  EXPECT_EQ(a.number, b.number);
  EXPECT_EQ(a.attempt, b.attempt);
  EXPECT_EQ(a.result.end, b.result.end);
  EXPECT_EQ(a.result.execution_time, b.result.execution_time);
  EXPECT_EQ(a.result.path, b.result.path);
  EXPECT_EQ(a.result.position_error, b.result.position_error);
  EXPECT_EQ(a.result.orientation_error, b.result.orientation_error);
}

TEST(LinearStudy, IsTheSameBitForBitOnAnyNumberOfThreads) {
  const StudySetup s = setup();
  StudyOptions options;
  options.operators = 6;
  options.threads = 1;
  const LinearStudy one = run(s, options);
  for (const int threads : {2, 5}) {
    options.threads = threads;
    const LinearStudy more = run(s, options);
    ASSERT_EQ(one.trials.size(), more.trials.size());
    for (std::size_t i = 0; i < one.trials.size(); ++i) expect_same(one.trials[i], more.trials[i]);
    EXPECT_EQ(one.simulated_time, more.simulated_time);
  }
}

TEST(LinearStudy, AnOperatorIsTheSameInABiggerStudyAndAnotherWithAnotherSeed) {
  const StudySetup s = setup();
  StudyOptions options;
  options.operators = 2;
  const LinearStudy few = run(s, options);
  options.operators = 4;
  const LinearStudy more = run(s, options);
  for (std::size_t i = 0; i < few.trials.size(); ++i) expect_same(few.trials[i], more.trials[i]);
  options.seed = 2;
  EXPECT_NE(run(s, options).trials[0].result.path, few.trials[0].result.path);
}

TEST(LinearStudy, EveryOperatorSucceedsTheTrialsWantedInBothModesInRandomOrder) {
  const StudySetup s = setup();
  StudyOptions options;
  options.operators = 12;
  options.trials = 2;
  const LinearStudy study = run(s, options);
  std::set<StudyMode> first_modes;
  for (int person = 0; person < options.operators; ++person) {
    int done[kStudyModes] = {};
    int last_number[kStudyModes] = {};
    bool first = true;
    for (const LinearStudyTrial& trial : study.trials) {
      if (trial.person != person) continue;
      if (first) first_modes.insert(trial.mode);
      first = false;
      int& last = last_number[static_cast<int>(trial.mode)];
      EXPECT_GT(trial.number, last) << "trials are numbered as they are made";
      last = trial.number;
      EXPECT_LE(trial.attempt, 6) << "three times as many as wanted";
      done[static_cast<int>(trial.mode)] += trial.result.end == TrialEnd::kDone;
    }
    EXPECT_EQ(done[0], 2) << person;
    EXPECT_EQ(done[1], 2) << person;
  }
  EXPECT_EQ(first_modes.size(), 2u);
}

TEST(LinearStudy, NvAloneIsTheNvOfTheWholeStudy) {
  const StudySetup s = setup();
  StudyOptions options;
  options.operators = 4;
  const LinearStudy both = run(s, options);
  options.only = {static_cast<int>(StudyMode::kFree)};
  const LinearStudy nv = run(s, options);
  std::size_t next = 0;
  for (const LinearStudyTrial& trial : both.trials) {
    if (trial.mode != StudyMode::kFree) continue;
    ASSERT_LT(next, nv.trials.size());
    expect_same(trial, nv.trials[next++]);
  }
  EXPECT_EQ(next, nv.trials.size());
}

TEST(LinearStudy, GivesUpAfterThreeTimesTheTrialsWanted) {
  const StudySetup s = setup({"operator.vision_noise_depth_mm=60"});
  StudyOptions options;
  options.operators = 1;
  options.trials = 1;
  const LinearStudy study = run(s, options);
  int nv = 0;
  for (const LinearStudyTrial& trial : study.trials) nv += trial.mode == StudyMode::kFree;
  EXPECT_EQ(nv, 3);
}

TEST(LinearStudy, OnlyTheOperatorsAskedForAreTraced) {
  const StudySetup s = setup();
  StudyOptions options;
  options.operators = 2;
  options.traced = 1;
  for (const LinearStudyTrial& trial : run(s, options).trials) {
    EXPECT_EQ(trial.result.trace.empty(), trial.person != 0);
  }
}

TEST(LinearStudy, SaysThatItWasCancelled) {
  const StudySetup s = setup();
  const std::atomic<bool> cancelled = true;
  StudyOptions options;
  options.cancelled = &cancelled;
  EXPECT_NE(run_linear_study(s.machine, s.population, options).message().find("cancelled"),
            std::string::npos);
}

}  // namespace
}  // namespace handrail
