#include "server/lab/study/screw/screw_report_io.h"

#include <gmock/gmock.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include "proto/screw_study.pb.h"
#include "tests/unit/lab_study_screw/screw_samples.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr BumperSettings::Form kForm = BumperSettings::Form::kDefault;

StudyHeader screw_header() { return {"the-scene", "the-people", 5, 5, 1}; }

pb::ScrewStudy screw_parsed(const std::string& json) {
  pb::ScrewStudy out;
  const auto status = google::protobuf::util::JsonStringToMessage(json, &out);
  EXPECT_TRUE(status.ok()) << status.ToString();
  return out;
}

TEST(ScrewReport, JsonHasTheKeysOfTheMeasures) {
  const std::string json = screw_json(screw_header(), kForm, five_people(), {});
  for (const char* part : {"\"experiment\": \"screw-fastening\"",
                           "\"simulated\": true",
                           "\"seed\": 5",
                           "\"bumper\": \"default\"",
                           "\"modes\": {",
                           "\"NC-NV\": {",
                           "\"NC-V\": {",
                           "\"C-NV\": {",
                           "\"C-V\": {",
                           "\"completion_time_s\": {",
                           "\"path_mm\": {",
                           "\"mean_contact_force_n\": {",
                           "\"max_contact_force_n\": {",
                           "\"impulse_n_s\": {",
                           "\"contact_time_s\": {",
                           "\"failures\": {",
                           "\"median_95\": {",
                           "\"tools_help\": {",
                           "\"protection_helps\": {",
                           "\"trials\": [",
                           "\"mode\": \"NC-NV\""}) {
    EXPECT_THAT(json, HasSubstr(part));
  }
  EXPECT_THAT(json, Not(HasSubstr("NC_NV")));
  EXPECT_THAT(screw_json(screw_header(), BumperSettings::Form::kPublished, five_people(), {}),
              HasSubstr("\"bumper\": \"published\""));
}

TEST(ScrewReport, JsonHasTheMeasuresOfAllModesInTheirUnits) {
  const pb::ScrewStudy study = screw_parsed(screw_json(screw_header(), kForm, five_people(), {}));
  const pb::ScrewMode& nc_nv = study.modes().nc_nv();
  EXPECT_NEAR(nc_nv.completion_time_s().median(), 40.8, 1e-9);
  EXPECT_NEAR(nc_nv.path_mm().median(), 255.0, 1e-9);
  EXPECT_NEAR(nc_nv.mean_contact_force_n().median(), 51.0, 1e-9);
  EXPECT_NEAR(nc_nv.max_contact_force_n().median(), 102.0, 1e-9);
  EXPECT_NEAR(nc_nv.impulse_n_s().median(), 408.0, 1e-9);
  EXPECT_NEAR(nc_nv.contact_time_s().median(), 8.0, 1e-9);
  EXPECT_DOUBLE_EQ(nc_nv.completion_time_s().published(), 42.1);
  EXPECT_FALSE(nc_nv.max_contact_force_n().has_published());
  EXPECT_NEAR(nc_nv.worst_force_n(), 104.0, 1e-9);
  EXPECT_EQ(nc_nv.trials(), 5u);
  EXPECT_DOUBLE_EQ(study.modes().nc_v().path_mm().published(), 153.4);
  EXPECT_DOUBLE_EQ(study.modes().c_nv().path_mm().published(), 257.0);
  EXPECT_NEAR(study.modes().c_v().path_mm().median(), 153.0, 1e-9);
  EXPECT_DOUBLE_EQ(study.modes().c_v().mean_contact_force_n().published(), 26.0);
}

TEST(ScrewReport, JsonComparesToolsAndProtection) {
  ScrewStudy five = five_people();
  for (ScrewStudyTrial& trial : five.trials) {
    if (trial.mode == ScrewMode::kCV) trial.result.measured.path *= 0.5;
  }
  result_of(five, 1, ScrewMode::kNCNV).end = ScrewEnd::kKeyLost;
  const pb::ScrewStudy study = screw_parsed(screw_json(screw_header(), kForm, five, {}));
  EXPECT_NEAR(study.tools_help().c().path_mm().ratio(), 0.3, 1e-12);
  EXPECT_NEAR(study.tools_help().c().completion_time_s().ratio(), 0.8, 1e-12);
  EXPECT_DOUBLE_EQ(study.tools_help().c().completion_time_s().helped(), 1.0);
  EXPECT_NEAR(study.protection_helps().nv().mean_contact_force_n().ratio(), 0.5, 1e-12);
  EXPECT_NEAR(study.protection_helps().v().path_mm().ratio(), 0.5, 1e-12);
  EXPECT_EQ(study.protection_helps().nv().failures().without(), 1u);
  EXPECT_EQ(study.protection_helps().nv().failures().with(), 0u);
  EXPECT_DOUBLE_EQ(study.protection_helps().nv().failures().no_more(), 1.0);
  EXPECT_EQ(study.tools_help().c().failures().without(), 0u);
}

TEST(ScrewReport, AFailedTrialIsCountedByItsEndAndStillTold) {
  ScrewStudy five = five_people();
  result_of(five, 0, ScrewMode::kNCNV).end = ScrewEnd::kForce;
  result_of(five, 1, ScrewMode::kNCNV).end = ScrewEnd::kKeyLost;
  result_of(five, 2, ScrewMode::kNCNV).end = ScrewEnd::kTimeOut;
  result_of(five, 3, ScrewMode::kNCV).end = ScrewEnd::kSession;
  const std::string json = screw_json(screw_header(), kForm, five, {});
  const pb::ScrewStudy study = screw_parsed(json);
  EXPECT_EQ(study.modes().nc_nv().failures().force(), 1u);
  EXPECT_EQ(study.modes().nc_nv().failures().key_lost(), 1u);
  EXPECT_EQ(study.modes().nc_nv().failures().timed_out(), 1u);
  EXPECT_EQ(study.modes().nc_nv().failures().session_lost(), 0u);
  EXPECT_EQ(study.modes().nc_v().failures().session_lost(), 1u);
  EXPECT_THAT(json, HasSubstr("\"median\": \"Infinity\"")) << "three of five failed";
  EXPECT_EQ(study.modes().nc_nv().completion_time_s().failures(), 3u);
  EXPECT_EQ(study.modes().nc_nv().mean_contact_force_n().failures(), 0u) << "their forces count";
  EXPECT_EQ(study.modes().nc_v().completion_time_s().failures(), 1u);
  EXPECT_EQ(study.modes().c_v().completion_time_s().failures(), 0u);
  EXPECT_NEAR(study.modes().nc_nv().mean_contact_force_n().median(), 51.0, 1e-9)
      << "their forces count";
  ASSERT_EQ(study.trials_size(), 20);
  EXPECT_NEAR(study.trials(0).completion_time_s(), 40.0, 1e-9);
  EXPECT_NEAR(study.trials(0).path_mm(), 250.0, 1e-9);
  EXPECT_EQ(study.trials(0).end(), name_of(ScrewEnd::kForce));
  EXPECT_EQ(study.trials(0).misses(), 2u);
  EXPECT_EQ(study.trials(1).mode(), "NC-V");
}

TEST(ScrewReport, TheTableHasAColumnOfFailedTrials) {
  ScrewStudy five = five_people();
  result_of(five, 0, ScrewMode::kNCNV).end = ScrewEnd::kForce;
  result_of(five, 1, ScrewMode::kNCNV).end = ScrewEnd::kTimeOut;
  const std::string table = screw_table(screw_header(), kForm, five, {});
  const std::size_t heading = table.find("failed ");
  ASSERT_NE(heading, std::string::npos);
  const std::size_t column = heading - table.rfind('\n', heading) - 1;
  const auto failed = [&](const std::string& start) {
    const std::size_t row = table.find('\n' + start);
    EXPECT_NE(row, std::string::npos) << start;
    return table.substr(row + 1 + column - 2, 8);
  };
  EXPECT_EQ(failed("completion time [s]               NC-NV "), "       2");
  EXPECT_EQ(failed("                                  NC-V  "), "       0");
  EXPECT_EQ(failed("path of the tip [mm]              NC-NV "), "       2");
  EXPECT_EQ(failed("mean contact force [N]            NC-NV "), "       0");
}

TEST(ScrewReport, VariationsStandBesideTheStudy) {
  ScrewStudy other = five_people();
  for (ScrewStudyTrial& trial : other.trials) trial.result.completion_time += 30.0;
  const std::vector<ScrewVariation> variations = {{"operator.press_mm=1", other}};
  const pb::ScrewStudy study =
      screw_parsed(screw_json(screw_header(), kForm, five_people(), variations));
  ASSERT_EQ(study.variations_size(), 1);
  EXPECT_EQ(study.variations(0).setting(), "operator.press_mm=1");
  EXPECT_NEAR(study.variations(0).modes().nc_nv().completion_time_s().median(), 70.8, 1e-9);
  const std::string table = screw_table(screw_header(), kForm, five_people(), variations);
  EXPECT_THAT(table, HasSubstr("medians side by side, C-V"));
  EXPECT_THAT(table, HasSubstr("operator.press_mm=1"));
  EXPECT_THAT(screw_table(screw_header(), kForm, five_people(), {}),
              Not(HasSubstr("side by side")));
}

TEST(ScrewReport, TheTableHasWhatIsImpliedAndTheTargets) {
  const std::string table = screw_table(screw_header(), kForm, five_people(), {});
  for (const char* part : {"5 simulated operators",
                           "default bumper",
                           "implied",
                           "42.1",
                           "33.3",
                           "36.6",
                           "28.7",
                           "271",
                           "153.4",
                           "257",
                           "166.5",
                           "50.2",
                           "48.6",
                           "26.7",
                           "26",
                           "NC-V / NC-NV",
                           "C-V / NC-V",
                           "0.566",
                           "failed trials",
                           "C-NV   0 of 5 (0 over 500 N, 0 key lost, 0 timed out, 0 session",
                           "the model reproduces",
                           "dissertation 46.8 % lower",
                           "targets",
                           "worst trial over 400 N without protection"}) {
    EXPECT_THAT(table, HasSubstr(part));
  }
  EXPECT_THAT(table, ::testing::ContainsRegex("worst trial over 400 N[^\n]* 104 N  NOT met"));
  EXPECT_THAT(table, ::testing::ContainsRegex("under 200 N[^\n]* 52 N  met"));
}

}  // namespace
}  // namespace handrail
