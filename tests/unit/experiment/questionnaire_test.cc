#include "client/experiment/questionnaire.h"

#include <gmock/gmock.h>

#include <sstream>

#include <google/protobuf/util/json_util.h>
#include "client/experiment/experiment_file_io.h"
#include "client/experiment/experiment_results_io.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

pb::ExperimentAnswers answers(const std::string& typed, const pb::ExperimentAnswers& before = {},
                              std::string* said = nullptr) {
  std::istringstream in(typed);
  std::ostringstream out;
  pb::ExperimentAnswers got = ask(statements_of("gearshift"), before, in, out);
  if (said != nullptr) *said = out.str();
  return got;
}

TEST(Questionnaire, KeepsWhatIsAnswered) {
  const pb::ExperimentAnswers got = answers("4\n 5 \r\n1\n");
  EXPECT_EQ(score_of(got, "resemblance"), 4u);
  EXPECT_EQ(score_of(got, "guidance"), 5u);
  EXPECT_EQ(score_of(got, "visual effect"), 1u);
  EXPECT_TRUE(statements_of("linear-movement").empty());
}

TEST(Questionnaire, AWrongAnswerIsToldAndAskedAgain) {
  std::string said;
  const pb::ExperimentAnswers got = answers("0\n6\nfive\n\n45\n3\n5\n5\n", {}, &said);
  EXPECT_EQ(score_of(got, "resemblance"), 3u);
  for (const char* wrong : {"'0'", "'6'", "'five'", "''", "'45'"}) {
    EXPECT_THAT(said, HasSubstr(std::string(wrong) + " is no score"));
  }
}

TEST(Questionnaire, WhatIsNotAnsweredIsKeptAsSuchAndAskedAgainAlone) {
  const pb::ExperimentAnswers got = answers("2\n");
  ASSERT_EQ(got.answer_size(), 3);
  EXPECT_TRUE(got.answer(0).has_score());
  EXPECT_FALSE(got.answer(1).has_score());
  EXPECT_FALSE(got.answer(2).has_score());
  std::string said;
  const pb::ExperimentAnswers again = answers("4\n5", got, &said);
  EXPECT_THAT(said, Not(HasSubstr("real manual gearshift")));
  EXPECT_EQ(score_of(again, "resemblance"), 2u);
  EXPECT_EQ(score_of(again, "guidance"), 4u);
  EXPECT_EQ(score_of(again, "visual effect"), 5u) << "a last line without an end";
}

// Of the person, with these seconds for their counted trials and those answers.
ExperimentRecord person(const char* experiment, bool simulated, std::vector<double> times,
                        const std::string& typed) {
  ExperimentRecord out;
  out.subject.set_experiment(experiment);
  out.subject.set_simulated(simulated);
  for (const double time : times) {
    pb::ExperimentTrial& trial = out.trials.emplace_back();
    trial.mutable_walls()->set_end(time > 0.0 ? "done" : "time-out");
    trial.mutable_walls()->set_time_s(time);
  }
  pb::ExperimentTrial& practice = out.trials.emplace_back();
  practice.set_practice(true);
  practice.mutable_walls()->set_end("done");
  practice.mutable_walls()->set_time_s(1000.0);
  std::istringstream in(typed);
  std::ostringstream ignored;
  out.answers = ask(statements_of(experiment), {}, in, ignored);
  return out;
}

TEST(WallResults, AnswersStandBesideWhatWasPublished) {
  const std::vector<ExperimentRecord> people = {
      person("gearshift", false, {20.0, 30.0}, "1\n5\n4\n"),
      person("gearshift", false, {70.0}, "2\n5\n"),
      person("gearshift", false, {}, "5\n5\n"),
  };
  const std::string table = results_text(people, false);
  EXPECT_THAT(table, HasSubstr("gearshift: 3 people, 3 trials that count, 0 of them failed"));
  EXPECT_THAT(table, HasSubstr("time [s]                                        20      40      30"
                               "      70"));
  EXPECT_THAT(table, HasSubstr("resemblance (3 answers)                          1    2.67       2"
                               "       5   mean 3.5, median 3.5, min 3, max 4"));
  EXPECT_THAT(table, HasSubstr("visual effect (1 answers)                        4       4       4"
                               "       4   mean 4.6, median 5.0\n"));
  const std::string json = results_text(people, true);
  pb::WallExperiment read;
  ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(json, &read).ok()) << json;
  ASSERT_EQ(read.score_size(), 3);
  EXPECT_EQ(read.score(0).max(), 5.0);
  EXPECT_EQ(read.score(0).published_median(), 3.5);
  EXPECT_EQ(read.measure(0).measure(), "time_s");
  EXPECT_EQ(read.measure(0).values().median(), 30.0);
  EXPECT_EQ(read.trial_size(), 3);
}

TEST(WallResults, AFailedTrialIsTheWorstRank) {
  const std::string table = results_text({person("wrench", false, {20.0, -1.0, -1.0}, "")}, false);
  EXPECT_THAT(table, HasSubstr("3 trials that count, 2 of them failed"));
  EXPECT_THAT(table, HasSubstr("time [s]                                        20      20       -"
                               "      20"));
}

TEST(WallResults, SimulatedPeopleHaveNoFeelings) {
  const std::vector<ExperimentRecord> people = {person("wrench", true, {20.0}, "1\n1\n1\n")};
  EXPECT_THAT(results_text(people, false), HasSubstr("1 simulated person"));
  EXPECT_THAT(results_text(people, false), HasSubstr("they feel nothing"));
  EXPECT_THAT(results_text(people, false), Not(HasSubstr("resemblance")));
  EXPECT_THAT(results_text(people, true), Not(HasSubstr("resemblance")));
}

TEST(WallResults, AnswersComeBackFromTheFile) {
  pb::ExperimentLine subject, first, second;
  subject.mutable_subject()->set_experiment("gearshift");
  *first.mutable_answers() = answers("2\n");
  *second.mutable_answers() = answers("4\n3\n", first.answers());
  const auto read =
      parse_experiment("f.jsonl", line_of(subject) + line_of(first) + line_of(second));
  ASSERT_TRUE(read) << read.message();
  EXPECT_EQ(score_of(read->answers, "resemblance"), 2u);
  EXPECT_EQ(score_of(read->answers, "visual effect"), 3u);
}

}  // namespace
}  // namespace handrail
