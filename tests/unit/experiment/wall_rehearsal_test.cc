// Trials among walls in virtual time.
#include "client/experiment/rehearsal/wall_rehearsal.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <string>
#include <vector>

namespace handrail {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

pb::WallTrial made_by(const std::string& experiment, const std::string& subject) {
  const auto record = rehearse(experiment, subject);
  EXPECT_TRUE(record) << record.message();
  return record ? record->trials.at(0).walls() : pb::WallTrial();
}

TEST(WallRehearsal, AGearshiftGoesThroughAllGearsTheSameEachTime) {
  const pb::WallTrial trial = made_by("gearshift", "p3");
  EXPECT_EQ(trial.end(), "done");
  EXPECT_THAT(trial.visited(), ElementsAre("N", "1", "2", "3", "4", "5", "R", "N"));
  EXPECT_GT(trial.max_wall_force_n(), 2.0);
  EXPECT_GT(trial.time_s(), 8.0);
  EXPECT_EQ(made_by("gearshift", "p3").time_s(), trial.time_s());
  EXPECT_NE(made_by("gearshift", "p4").time_s(), trial.time_s());
}

TEST(WallRehearsal, AWrenchIsLoosenedAgainWhereItsCIsSet) {
  const pb::WallTrial twice = made_by("wrench", "p1");
  EXPECT_EQ(twice.end(), "done");
  EXPECT_NEAR(twice.turned_rad(), 6.5, 0.1);  // two of the path's halves and what leads to them
  EXPECT_EQ(twice.screw_c(), 5.0);
  const pb::WallTrial back = made_by("wrench-loosening", "p1");
  EXPECT_EQ(back.end(), "done");
  EXPECT_EQ(back.screw_c(), 15.0);
  // As many turns back: what is left is of the hand that leaves the aisle early or late.
  EXPECT_NEAR(back.turned_rad(), 0.0, 0.2);
}

// The hand is as late behind the ball as that of the same ten people at the running programs, whose
// median is 2.54 mm: a millisecond more or less is 0.04 mm.
TEST(WallRehearsal, AHandIsAsLateAsAtTheRunningPrograms) {
  std::vector<double> behind;
  for (int i = 1; i <= 10; ++i)
    behind.push_back(
        made_by("wrench", (i < 10 ? "p0" : "p") + std::to_string(i)).mean_from_ball_mm());
  std::sort(behind.begin(), behind.end());
  EXPECT_NEAR(0.5 * (behind[4] + behind[5]), 2.54, 0.04);
}

TEST(WallRehearsal, WhatHasNoWallsIsTold) {
  EXPECT_THAT(rehearse("linear-movement", "p1").message(), HasSubstr("has no walls"));
  EXPECT_THAT(rehearsal_text("gearshift", 3, true, [] { return true; }).message(),
              HasSubstr("cancelled"));
  EXPECT_THAT(*rehearsal_text("gearshift", 2, false, [] { return false; }),
              HasSubstr("2 simulated people, 2 trials that count"));
}

}  // namespace
}  // namespace handrail
