#include "server/lab/study/study_run.h"

#include <gtest/gtest.h>

#include <map>
#include <mutex>
#include <set>

#include "server/lab/study/population_io.h"
#include "tests/unit/lab_study/population_samples.h"

namespace handrail {
namespace {

constexpr int kModes = 4;
enum class Mode { kA, kB, kC, kD };
enum class End { kDone, kMissed };

struct Trial {
  int subject = 0;
  Mode mode = Mode::kA;
  OperatorParameters person;
  int number = 1;
  std::uint64_t seed = 1;
  std::uint64_t arm_seed = 1;
  bool keep_trace = false;
};

struct Outcome {
  End end = End::kDone;
  double simulated_time = 1.0;
  Trial asked;
};

using Study = StudyResult<Mode, Outcome>;

Population study_people() {
  auto out = parse_population("p", population_text());
  EXPECT_TRUE(out) << out.message();
  return out ? std::move(*out) : Population();
}

Study run(const StudyPlan& plan, const std::function<End(const Trial&)>& end_of) {
  const auto study = run_study<Study>(plan, kModes, study_people(), Trial(),
                                      [&](const Trial& trial) -> Result<Outcome> {
                                        return Outcome{end_of(trial), 1.0, trial};
                                      });
  EXPECT_TRUE(study) << study.message();
  return study ? *study : Study();
}

Study run(const StudyPlan& plan) {
  return run(plan, [](const Trial&) { return End::kDone; });
}

TEST(StudyRun, TheSameOperatorsMeetAllModes) {
  StudyPlan plan;
  plan.operators = 10;
  const Study study = run(plan);
  std::map<int, std::set<Mode>> met;
  std::map<int, Trial> first;
  std::set<double> speeds;
  for (const Study::Trial& trial : study.trials) {
    met[trial.person].insert(trial.mode);
    const Trial& asked = trial.result.asked;
    const Trial& same = first.try_emplace(trial.person, asked).first->second;
    EXPECT_EQ(asked.person.speed, same.person.speed);
    EXPECT_EQ(asked.person.press, same.person.press);
    EXPECT_EQ(asked.arm_seed, same.arm_seed);
    speeds.insert(asked.person.speed);
  }
  ASSERT_EQ(met.size(), 10u);
  for (const auto& [person, modes] : met) EXPECT_EQ(modes.size(), 4u) << person;
  EXPECT_EQ(speeds.size(), 10u) << "and no two are the same person";
}

TEST(StudyRun, EveryModeIsAsOftenFirstAsLast) {
  StudyPlan plan;
  plan.operators = 400;
  plan.trials = 1;
  std::map<Mode, int> first, last;
  const Study study = run(plan);
  for (std::size_t i = 0; i < study.trials.size(); i += kModes) {
    ++first[study.trials[i].mode];
    ++last[study.trials[i + kModes - 1].mode];
  }
  for (const Mode mode : {Mode::kA, Mode::kB, Mode::kC, Mode::kD}) {
    EXPECT_NEAR(first[mode], 100, 40) << "over 4.6 standard deviations";
    EXPECT_NEAR(last[mode], 100, 40);
  }
}

TEST(StudyRun, PracticeCountsInEveryModeThatCameBefore) {
  StudyPlan plan;
  plan.operators = 1;
  plan.trials = 2;
  plan.practice = 3;
  std::vector<int> numbers;
  for (const Study::Trial& trial : run(plan).trials) {
    numbers.push_back(trial.number);
    EXPECT_EQ(trial.number, trial.result.asked.number);
  }
  EXPECT_EQ(numbers, (std::vector<int>{4, 5, 9, 10, 14, 15, 19, 20}));
}

TEST(StudyRun, AModeThatFailsIsTriedThreeTimesAsOften) {
  StudyPlan plan;
  plan.operators = 5;
  plan.trials = 2;
  const Study study = run(
      plan, [](const Trial& trial) { return trial.mode == Mode::kC ? End::kMissed : End::kDone; });
  EXPECT_EQ(study.count(Mode::kC), 30);
  EXPECT_EQ(study.failures(Mode::kC), 30);
  EXPECT_EQ(study.count(Mode::kC, End::kMissed), 30);
  EXPECT_EQ(study.count(Mode::kA), 10);
  EXPECT_EQ(study.failures(Mode::kA), 0);
  EXPECT_DOUBLE_EQ(study.simulated_time, 60.0);
}

TEST(StudyRun, AModeAloneIsTheSameAsAmongTheOthers) {
  StudyPlan plan;
  plan.operators = 6;
  const Study all = run(plan);
  plan.only = {2};
  const Study alone = run(plan);
  std::size_t next = 0;
  for (const Study::Trial& trial : all.trials) {
    if (trial.mode != Mode::kC) continue;
    ASSERT_LT(next, alone.trials.size());
    const Study::Trial& same = alone.trials[next++];
    EXPECT_EQ(same.mode, trial.mode);
    EXPECT_EQ(same.number, trial.number);
    EXPECT_EQ(same.result.asked.seed, trial.result.asked.seed);
    EXPECT_EQ(same.result.asked.person.speed, trial.result.asked.person.speed);
  }
  EXPECT_EQ(next, alone.trials.size());
}

TEST(StudyRun, NoTwoTrialsOfAnOperatorHaveTheSameSeed) {
  StudyPlan plan;
  plan.operators = 3;
  std::set<std::uint64_t> seeds;
  const Study study = run(plan);
  for (const Study::Trial& trial : study.trials) seeds.insert(trial.result.asked.seed);
  EXPECT_EQ(seeds.size(), study.trials.size());
}

TEST(StudyRun, ValuesStandByOperatorAlsoWhereSomebodyHasNone) {
  Study study;
  for (const int person : {0, 0, 1, 2}) study.trials.push_back({person, Mode::kA, 1, 1, {}});
  study.trials[0].mode = study.trials[2].mode = Mode::kB;
  const ByPerson values =
      study.values(Mode::kA, [](const Outcome& outcome) { return outcome.simulated_time; });
  EXPECT_EQ(values, (ByPerson{{1.0}, {}, {1.0}}));
}

TEST(StudyRun, TheFirstErrorOfATrialIsTheStudys) {
  StudyPlan plan;
  plan.operators = 2;
  const auto study = run_study<Study>(
      plan, kModes, study_people(), Trial(),
      [](const Trial&) -> Result<Outcome> { return Status::error("no arm there"); });
  EXPECT_EQ(study.message(), "no arm there");
}

TEST(StudyRun, ACancelledStudyEndsAfterTheTrialUnderWay) {
  std::atomic<bool> cancelled = false;
  int made = 0;
  StudyPlan plan;
  plan.operators = 1;
  plan.threads = 1;
  plan.cancelled = &cancelled;
  const auto study = run_study<Study>(plan, kModes, study_people(), Trial(),
                                      [&](const Trial& trial) -> Result<Outcome> {
                                        cancelled = ++made == 3;
                                        return Outcome{End::kDone, 1.0, trial};
                                      });
  EXPECT_EQ(study.message(), "cancelled");
  EXPECT_EQ(made, 3);
}

}  // namespace
}  // namespace handrail
