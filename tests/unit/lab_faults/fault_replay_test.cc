// What the fault matrix records of its cells, and does again.
#include <gmock/gmock.h>

#include <algorithm>
#include <sstream>

#include "proto/record.pb.h"
#include "server/lab/faults/fault_rows.h"
#include "server/lab/replay/recording_csv.h"
#include "server/lab/replay/replay.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

void pass(Cell& cell, FaultRecording& recording, int ms) {
  HandReading hand;
  hand.valid = true;
  for (int i = 0; i < ms; ++i) {
    hand.X_MH.p.x() = 1e-5 * (i % 1000);
    cell.tick(hand, order_of(i % 1000 == 5 ? OrderKind::kEngage : OrderKind::kNone));
    recording.pull();
  }
}

TEST(FaultReplayTest, BothSidesAreDoneAgainThroughRestarts) {
  const auto cell = fault_cell(5, {});
  FaultRecording recording(*cell, {});
  pass(*cell, recording, 6000);
  cell->restart_master();
  pass(*cell, recording, 2000);
  cell->restart_slave();
  pass(*cell, recording, 2000);
  const FaultRecording::Again again = recording.again();
  EXPECT_EQ(again.problem, "");
  EXPECT_EQ(again.different, 0u);
  // All of the master's ticks, and nearly all that the controller answered: not the first ones.
  EXPECT_LE(again.replayed, 10'000u + cell->robot_counters().replies);
  EXPECT_GT(again.replayed, 9'980u + cell->robot_counters().replies);
}

TEST(FaultReplayTest, WhatWasNotOfThatSceneDiffers) {
  FaultOptions contact;
  contact.contact = true;
  const auto cell = fault_cell(5, contact);
  FaultRecording recording(*cell, {});
  pass(*cell, recording, 3000);
  const FaultRecording::Again again = recording.again();
  EXPECT_GT(again.different, 0u);
  EXPECT_THAT(again.problem, HasSubstr("slave: "));
  FaultOutcome told;
  find(told, again);
  EXPECT_EQ(told.violations, again.different + 1);
  EXPECT_THAT(told.found, HasSubstr("steps that differ in the replay, 1 x slave: "));
}

TEST(FaultReplayTest, EveryRowThatHasACellIsDoneAgain) {
  for (const FaultRow& row : fault_rows()) {
    if (row.id != std::string("N5") && row.id != std::string("S2a")) continue;
    RowRun run{.seed = 77, .index = 1, .share = kQuickShare, .replay = true};
    EXPECT_EQ(row.run(run).found, "") << row.id;
  }
}

TEST(CellRecordingTest, ATrialIsFoundByItsMarks) {
  const auto cell = fault_cell(5, {});
  std::ostringstream master, slave;
  pb::RecordedScene scene;
  scene.set_number(kCellScene);
  CellRecording recording(*cell, {}, {}, scene, master, slave);
  const auto pass_ms = [&](int ms) {
    for (int i = 0; i < ms; ++i) cell->tick({});
  };
  pass_ms(100);
  recording.mark("trial begins: gearshift walls anna 2 practice");
  pass_ms(50);
  recording.mark("half way");
  recording.mark("trial ends: gearshift walls anna 2 done");
  pass_ms(30);
  recording.mark("trial begins: gearshift walls anna 3");
  pass_ms(400);
  recording.finish();
  const auto rows = [&](int trial) {
    std::istringstream in(master.str());
    std::ostringstream out;
    return write_recording_csv(in, out, 0.0, trial);
  };
  EXPECT_EQ(*rows(0), 580u);
  EXPECT_EQ(*rows(2), 50u);
  EXPECT_EQ(*rows(3), 400u);
  EXPECT_THAT(rows(1).message(), HasSubstr("it has no trial 1 that is marked"));
}

}  // namespace
}  // namespace handrail
