#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "client/experiment/experiment_file_io.h"
#include "client/experiment/experiment_results_io.h"
#include "server/base/read_file.h"
#include "server/base/units.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

pb::ExperimentSubject somebody(const std::string& name = "anna", bool simulated = false) {
  pb::ExperimentSubject out;
  out.set_experiment("linear-movement");
  out.set_subject(name);
  out.set_simulated(simulated);
  out.set_trials(2);
  return out;
}

TrialResult result(double time) {
  TrialResult out;
  out.execution_time = time;
  out.path = 0.1669;
  out.position_error = 0.56e-3;
  out.orientation_error = 0.11 * kDeg;
  out.orientation_error_to_reference = 0.2 * kDeg;
  return out;
}

class ExperimentFileTest : public ::testing::Test {
 protected:
  std::string path() const {
    return experiment_file(folder_.path() + "/x", "linear-movement", "anna");
  }
  Status open(ExperimentFile& file, bool resume = false) {
    return file.open(path(), somebody(), resume, record_);
  }
  // A trial from its beginning to its end, or without one.
  void write(ExperimentFile& file, const TrialNext& next, bool ends, double time = 12.5) {
    pb::ExperimentLine line;
    *line.mutable_began() = trial_line(next);
    line.mutable_began()->set_practice(next.practice);
    ASSERT_TRUE(file.append(line));
    if (!ends) return;
    pb::ExperimentTrial ended = line.began();
    fill_ended(next, result(time), ended);
    *line.mutable_ended() = ended;
    ASSERT_TRUE(file.append(line));
  }

  TempFolder folder_;
  ExperimentRecord record_;
};

TEST_F(ExperimentFileTest, WhatWasWrittenIsReadBack) {
  {
    ExperimentFile file;
    ASSERT_TRUE(open(file));
    write(file, {0, true, 1, 0}, true);
    write(file, {1, false, 2, 1}, true, 14.75);
    write(file, {1, false, 3, 2}, false);
  }
  const auto read = read_experiment(path());
  ASSERT_TRUE(read) << read.message();
  EXPECT_EQ(read->subject.subject(), "anna");
  ASSERT_EQ(read->trials.size(), 3u);
  EXPECT_TRUE(read->trials[2].interrupted());
  const auto made = trials_made(*read);
  EXPECT_TRUE(made[0].practice && made[0].done && made[0].mode == 0);
  EXPECT_TRUE(!made[1].practice && made[1].done && made[1].mode == 1);
  EXPECT_TRUE(made[2].interrupted && !made[2].done);
  // The one that counts, as it was measured.
  const LinearStudy study = study_of({*read});
  ASSERT_EQ(study.trials.size(), 1u);
  EXPECT_EQ(study.trials[0].mode, StudyMode::kTools);
  EXPECT_EQ(study.trials[0].number, 2);
  const TrialResult& back = study.trials[0].result;
  EXPECT_EQ(back.end, TrialEnd::kDone);
  EXPECT_NEAR(back.execution_time, 14.75, 1e-12);
  EXPECT_NEAR(back.path, 0.1669, 1e-12);
  EXPECT_NEAR(back.position_error, 0.56e-3, 1e-12);
  EXPECT_NEAR(back.orientation_error, 0.11 * kDeg, 1e-12);
  EXPECT_NEAR(back.orientation_error_to_reference, 0.2 * kDeg, 1e-12);
}

// Whatever byte the program was killed at, all whole lines are there and the next is written well.
TEST_F(ExperimentFileTest, AFileThatIsCutAnywhereGoesOn) {
  {
    ExperimentFile file;
    ASSERT_TRUE(open(file));
    write(file, {0, true, 1, 0}, true);
    write(file, {0, true, 2, 0}, true);
  }
  const std::string whole = *read_file(path(), 1 << 20);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    std::ofstream(path(), std::ios::trunc) << whole.substr(0, size);
    ExperimentFile file;
    const Status opened = open(file, true);
    ASSERT_TRUE(opened) << size << ": " << opened.message();
    const std::size_t lines = static_cast<std::size_t>(
        std::count(whole.begin(), whole.begin() + static_cast<long>(size), '\n'));
    EXPECT_EQ(record_.trials.size(), lines / 2) << size;
    write(file, {0, true, 3, 0}, true);
    const auto read = read_experiment(path());
    ASSERT_TRUE(read) << size << ": " << read.message();
    EXPECT_FALSE(read->cut);
    EXPECT_EQ(read->trials.size(), lines / 2 + 1) << size;
    EXPECT_FALSE(read->trials.back().interrupted());
    EXPECT_EQ(read->subject.subject(), "anna");
  }
}

TEST_F(ExperimentFileTest, OneRunnerAtATime) {
  ExperimentFile first, second;
  ASSERT_TRUE(open(first));
  EXPECT_THAT(open(second, true).message(), HasSubstr("another `handrail experiment` has it open"));
}

TEST_F(ExperimentFileTest, WhatIsThereIsGoneOnWithOnlyIfAsked) {
  {
    ExperimentFile file;
    ASSERT_TRUE(open(file));
  }
  {
    ExperimentFile file;
    EXPECT_THAT(open(file).message(), HasSubstr("--resume goes on with it"));
  }
  {
    ExperimentFile file;
    EXPECT_TRUE(open(file, true));
  }
  ExperimentFile file;
  ExperimentRecord record;
  EXPECT_THAT(
      file.open(path(), somebody("anna", true), true, record).message(),
      HasSubstr("is of the person 'anna' in linear-movement, expected the simulated 'anna'"));
}

TEST_F(ExperimentFileTest, FilesThatAreNoneAreRefusedWithTheirPlace) {
  const std::pair<std::string, std::string> cases[] = {
      {"{}\n", ":1: expected the subject in the first line"},
      {"nonsense\n", ":1: no such line"},
      {line_of([] {
         pb::ExperimentLine l;
         *l.mutable_subject() = somebody();
         return l;
       }()) +
           "{\"ended\": {}}\n",
       ":2: a trial ends that did not begin"},
      {line_of([] {
         pb::ExperimentLine l;
         *l.mutable_subject() = somebody();
         return l;
       }()) +
           "{}\n",
       ":2: expected subject, began, ended or answers"},
      {line_of([] {
         pb::ExperimentLine l;
         *l.mutable_subject() = somebody();
         return l;
       }()) +
           line_of([] {
             pb::ExperimentLine l;
             *l.mutable_subject() = somebody();
             return l;
           }()),
       ":2: a second subject"},
      {"{\"subject\": {\"colour\": \"red\"}}\n", "colour"},
  };
  for (const auto& [text, wanted] : cases) {
    const auto read = parse_experiment("f.jsonl", text);
    ASSERT_FALSE(read) << text;
    EXPECT_THAT(read.message(), HasSubstr(wanted));
    EXPECT_THAT(read.message(), HasSubstr("f.jsonl:"));
  }
}

TEST_F(ExperimentFileTest, PeopleAndSimulatedPeopleAreNamedAsSuch) {
  for (const bool simulated : {false, true}) {
    ExperimentRecord record;
    record.subject = somebody("b", simulated);
    pb::ExperimentTrial trial = trial_line({0, false, 1, 1});
    fill_ended({0, false, 1, 1}, result(10.0), trial);
    record.trials = {trial};
    const std::string table = results_text({record}, false), json = results_text({record}, true);
    EXPECT_EQ(table.find("simulated") != std::string::npos, simulated) << table;
    EXPECT_THAT(json, HasSubstr(simulated ? "\"simulated\": true" : "\"simulated\": false"));
  }
}

}  // namespace
}  // namespace handrail
