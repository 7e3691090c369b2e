#include "server/lab/study/linear/linear_report_io.h"

#include <gmock/gmock.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "proto/study.pb.h"
#include "server/base/units.h"
#include "server/lab/study/linear/linear_drawing.h"
#include "server/lab/study/linear/linear_figure.h"
#include "server/lab/study/study_drawing.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

LinearStudyTrial trial(int person, StudyMode mode, double time, double path_mm,
                       TrialEnd end = TrialEnd::kDone) {
  LinearStudyTrial out;
  out.person = person;
  out.mode = mode;
  out.result.end = end;
  out.result.execution_time = time;
  out.result.path = path_mm * kMm;
  out.result.position_error = 0.01 * path_mm * kMm;
  out.result.orientation_error = time * kDeg;
  out.result.position_error_on_lines = 0.005 * path_mm * kMm;
  out.result.orientation_error_to_nominal = 2.0 * time * kDeg;
  out.result.trace = {{Vec3(0.35, 0.03, 0.33)}, {Vec3(0.35, -0.03, 0.33)}};
  return out;
}

// Three people: with tools each path is 50 mm shorter and each time 1 s longer.
LinearStudy three_people() {
  LinearStudy out;
  for (int person = 0; person < 3; ++person) {
    out.trials.push_back(trial(person, StudyMode::kFree, 10.0 + person, 200.0 + 10.0 * person));
    out.trials.push_back(trial(person, StudyMode::kTools, 11.0 + person, 150.0 + 10.0 * person));
  }
  return out;
}

StudyHeader header() { return {"the-scene", "the-people", 5, 3, 1}; }

pb::LinearStudy parsed(const std::string& json) {
  pb::LinearStudy out;
  const auto status = google::protobuf::util::JsonStringToMessage(json, &out);
  EXPECT_TRUE(status.ok()) << status.ToString();
  return out;
}

TEST(LinearReport, JsonHasTheMeasuresOfBothModesInMillimetresAndDegrees) {
  const std::string json = linear_json(header(), three_people(), {});
  const pb::LinearStudy study = parsed(json);
  EXPECT_EQ(study.experiment(), "linear-movement");
  EXPECT_TRUE(study.simulated());
  EXPECT_THAT(json, HasSubstr("\"seed\": 5,"));
  EXPECT_EQ(study.scene(), "the-scene");
  EXPECT_EQ(study.population(), "the-people");
  const pb::LinearMode& nv = study.modes().nv();
  EXPECT_DOUBLE_EQ(nv.execution_time_s().min(), 10.0);
  EXPECT_DOUBLE_EQ(nv.execution_time_s().q1(), 10.5);
  EXPECT_DOUBLE_EQ(nv.execution_time_s().median(), 11.0);
  EXPECT_DOUBLE_EQ(nv.execution_time_s().q3(), 11.5);
  EXPECT_DOUBLE_EQ(nv.execution_time_s().max(), 12.0);
  EXPECT_DOUBLE_EQ(nv.execution_time_s().mean(), 11.0);
  EXPECT_DOUBLE_EQ(nv.execution_time_s().published(), 14.6);
  EXPECT_NEAR(nv.path_mm().median(), 210.0, 1e-9);
  EXPECT_NEAR(nv.max_position_error_mm().median(), 2.1, 1e-9);
  EXPECT_NEAR(nv.max_position_error_on_lines_mm().median(), 1.05, 1e-9);
  EXPECT_NEAR(nv.max_orientation_error_deg().median(), 11.0, 1e-9);
  EXPECT_NEAR(nv.max_orientation_error_to_nominal_deg().median(), 22.0, 1e-9);
  EXPECT_NEAR(study.modes().v().path_mm().median(), 160.0, 1e-9);
  EXPECT_DOUBLE_EQ(study.modes().v().path_mm().published(), 166.9);
  for (const char* key : {"\"NV\": {", "\"V\": {", "\"execution_time_s\": {", "\"path_mm\": {",
                          "\"max_position_error_mm\": {", "\"max_orientation_error_deg\": {"}) {
    EXPECT_THAT(json, HasSubstr(key));
  }
}

TEST(LinearReport, JsonTellsEveryTrialAndComparesPersonByPerson) {
  const pb::LinearStudy study = parsed(linear_json(header(), three_people(), {}));
  ASSERT_EQ(study.trials_size(), 6);
  EXPECT_EQ(study.trials(3).person(), 1U);
  EXPECT_EQ(study.trials(3).mode(), "V");
  EXPECT_EQ(study.trials(3).end(), "done");
  EXPECT_NEAR(study.trials(3).path_mm(), 160.0, 1e-9);
  EXPECT_NEAR(study.tools_help().path_mm().ratio(), 160.0 / 210.0, 1e-12);
  EXPECT_DOUBLE_EQ(study.tools_help().path_mm().helped(), 1.0);
  EXPECT_DOUBLE_EQ(study.tools_help().execution_time_s().helped(), 0.0);
  EXPECT_LE(study.tools_help().path_mm().ratio_95().low(), 160.0 / 210.0);
  EXPECT_GE(study.tools_help().path_mm().ratio_95().high(), 160.0 / 210.0);
}

TEST(LinearReport, AFailedTrialIsTheWorstRankAndIsCountedByItsEnd) {
  LinearStudy study = three_people();
  study.trials[0].result.end = TrialEnd::kTimeOut;
  study.trials[2].result.end = TrialEnd::kOffTarget;
  const std::string json = linear_json(header(), study, {});
  const pb::LinearStudy out = parsed(json);
  EXPECT_EQ(out.modes().nv().trials(), 3U);
  EXPECT_EQ(out.modes().nv().timed_out(), 1U);
  EXPECT_EQ(out.modes().nv().off_target(), 1U);
  EXPECT_EQ(out.modes().v().off_target(), 0U);
  EXPECT_THAT(json, HasSubstr("\"median\": \"Infinity\""));
  EXPECT_DOUBLE_EQ(out.modes().nv().execution_time_s().min(), 12.0);
  EXPECT_EQ(out.modes().nv().execution_time_s().failures(), 2U);
  EXPECT_EQ(out.modes().nv().max_orientation_error_deg().failures(), 2U);
  EXPECT_EQ(out.modes().v().execution_time_s().failures(), 0U);
  EXPECT_THAT(json, HasSubstr("\"failures\": 2"));
  EXPECT_EQ(out.trials(0).end(), "time-out");
  EXPECT_NEAR(out.trials(0).path_mm(), 200.0, 1e-9) << "what it did is still told";
}

// Every measure has the number beside its figures: two of three without tools, one of three with.
TEST(LinearReport, TheTableHasAColumnOfFailedTrials) {
  LinearStudy study = three_people();
  study.trials[0].result.end = TrialEnd::kTimeOut;
  study.trials[2].result.end = TrialEnd::kOffTarget;
  study.trials[3].result.end = TrialEnd::kSession;
  std::istringstream lines(linear_table(header(), study, {}));
  std::size_t column = std::string::npos;  // where it ends
  int nv = 0, v = 0;
  for (std::string line; std::getline(lines, line) && nv + v < 2 * kLinearFigures;) {
    if (const std::size_t at = line.find("failed"); column == std::string::npos) {
      if (at != std::string::npos) column = at + 6;
      continue;
    }
    const std::string mode = line.substr(34, 6), failed = line.substr(column - 8, 8);
    if (mode == "NV    ") nv += failed == "       2" ? 1 : 1000;
    if (mode == "V     ") v += failed == "       1" ? 1 : 1000;
  }
  EXPECT_EQ(nv, kLinearFigures);
  EXPECT_EQ(v, kLinearFigures);
}

TEST(LinearReport, VariationsStandBesideTheStudy) {
  LinearStudy other = three_people();
  for (LinearStudyTrial& t : other.trials) t.result.execution_time += 5.0;
  const std::vector<LinearVariation> variations = {{"guidance.delta_mm=1", other}};
  const pb::LinearStudy out = parsed(linear_json(header(), three_people(), variations));
  ASSERT_EQ(out.variations_size(), 1);
  EXPECT_EQ(out.variations(0).setting(), "guidance.delta_mm=1");
  EXPECT_DOUBLE_EQ(out.variations(0).modes().nv().execution_time_s().median(), 16.0);
  const std::string table = linear_table(header(), three_people(), variations);
  EXPECT_THAT(table, HasSubstr("guidance.delta_mm=1"));
  EXPECT_THAT(table, HasSubstr("side by side"));
}

TEST(LinearReport, TheTableSaysThatOperatorsAreSimulatedAndGivesPublishedMediansBeside) {
  const std::string table = linear_table(header(), three_people(), {});
  for (const char* part : {"3 simulated operators", "215.3", "166.9", "14.6", "0.56", "100 %"}) {
    EXPECT_THAT(table, HasSubstr(part));
  }
  EXPECT_THAT(table, ::testing::Not(HasSubstr("side by side")));
}

TEST(LinearDrawing, WritesBothFiguresIntoAFolderItMakes) {
  const TempFolder folder;
  const std::string path = folder.path() + "/new/figures";
  LinearTask task;
  task.p_SA = Vec3(0.35, 0.04, 0.33);
  task.p_SB = Vec3(0.35, -0.04, 0.33);
  task.p_SC = Vec3(0.35, -0.04, 0.25);
  ASSERT_TRUE(make_folder(path));
  const Status status = draw_linear(path, header(), three_people(), task);
  ASSERT_TRUE(status) << status.message();
  for (const char* name : {"linear-movement-measures.svg", "linear-movement-trajectories.svg"}) {
    std::ifstream file(path + "/" + name);
    std::stringstream text;
    text << file.rdbuf();
    EXPECT_THAT(text.str(), HasSubstr("<svg")) << name;
    EXPECT_THAT(text.str(), HasSubstr("Simulated operators")) << name;
  }
}

TEST(LinearDrawing, NamesTheFolderItCannotMake) {
  EXPECT_THAT(make_folder("/proc/no/such").message(), HasSubstr("/proc/no"));
  EXPECT_THAT(draw_linear("/proc/no", header(), three_people(), LinearTask()).message(),
              HasSubstr("/proc/no"));
}

}  // namespace
}  // namespace handrail
