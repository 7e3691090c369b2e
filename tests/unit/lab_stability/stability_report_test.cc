#include "server/lab/stability/stability_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace handrail {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

StabilityCase named(const std::string& name, bool must_hold, bool drawn) {
  return {name, must_hold, drawn, {}};
}

TEST(StabilityReport, CountsFamiliesAndNamesWhatFailsSoThatItCanBeRunAgain) {
  const StabilityCase onset = named("onset/a", true, false), on = named("walls/a/on", true, true),
                      off = named("walls/a/off", false, true);
  const std::vector<CaseRun> runs = {
      {&onset, 1, CaseFigures{judged("off", 0.5, 1.0)}},
      {&on, 3, CaseFigures{judged("x_mj", 2.5, 1.0), judged("y", 0.0, 1.0)}},
      {&on, 4, CaseFigures{judged("x_mj", 1.0, 1.0)}},
      {&off, 3, CaseFigures{judged("x_mj", 7.0, 1.0)}}};
  const std::string table = stability_table(runs, false);
  EXPECT_THAT(table, HasSubstr("| onset | 1 of 1 | - | - |\n| walls | 1 of 2 | 0 of 1 | - |\n"));
  EXPECT_THAT(table, HasSubstr("FAILS --case walls/a/on --seed 3: x_mj 2.5 > 1\n"));
  EXPECT_THAT(table, Not(HasSubstr("walls/a/off")));
}

TEST(StabilityReport, OfAChosenCaseEveryFigureIsTold) {
  const StabilityCase off = named("walls/a/off", false, true);
  const std::string text = stability_table(
      {{&off, 3, CaseFigures{judged("x_mj", 7.0, 1.0), told("contacts", 4.0)}}}, true);
  EXPECT_EQ(text, "unstable --case walls/a/off --seed 3: x_mj 7 > 1; contacts 4\n");
}

TEST(StabilityReport, WhatIsRefusedNeitherHoldsNorFailsAndIsCountedApart) {
  const StabilityCase on = named("teleoperation/a", true, true);
  const std::vector<CaseRun> runs = {{&on, 1, Refused{"refused: 30 % lost"}},
                                     {&on, 2, CaseFigures{judged("x_mj", 0.5, 1.0)}}};
  EXPECT_FALSE(runs[0].failed());
  EXPECT_FALSE(runs[0].holds());
  EXPECT_THAT(stability_table(runs, false), HasSubstr("| teleoperation | 1 of 1 | - | 1 |\n"));
  EXPECT_THAT(stability_table(runs, true),
              HasSubstr("refused --case teleoperation/a --seed 1: refused: 30 % lost\n"));
  EXPECT_EQ(stability_json({runs[0]}),
            "{\"case\": \"teleoperation/a\", \"seed\": 1, \"must_hold\": true, \"holds\": false, "
            "\"refused\": \"refused: 30 % lost\"}\n");
}

TEST(StabilityReport, AFigureThatIsNoNumberDoesNotHoldAndIsNullInJson) {
  const StabilityCase on = named("walls/a/on", true, true);
  const CaseRun run{&on, 1, CaseFigures{judged("x_mj", std::nan(""), 1.0), told("contacts", 4.0)}};
  EXPECT_TRUE(run.failed());
  EXPECT_EQ(stability_json({run}),
            "{\"case\": \"walls/a/on\", \"seed\": 1, \"must_hold\": true, \"holds\": false, "
            "\"x_mj\": null, \"x_mj_most\": 1, \"contacts\": 4}\n");
}

}  // namespace
}  // namespace handrail
