// Both sides, the link and the arm, in a passive hand.
#include "server/lab/stability/whole_loop.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "server/base/units.h"
#include "server/kinematics/rv2a.h"
#include "server/lab/stability/arm_cell.h"
#include "server/lab/stability/bench_device.h"
#include "server/lab/stability/long_run.h"
#include "server/lab/stability/teleop_cell.h"
#include "server/model/rv2a_limits.h"

namespace handrail {
namespace {

std::map<std::string, double> values(const CaseOutcome& outcome) {
  EXPECT_EQ(outcome.refused, "");
  std::map<std::string, double> out;
  for (const CaseFigure& f : outcome.figures) out[f.name] = f.value;
  return out;
}

WholeLoopOptions free_space() {
  WholeLoopOptions out;
  out.scene.name = "free";
  out.scene.limits.joints = rv2a_limits();
  out.grip = stylus_grip(250.0);
  return out;
}

TEST(WholeLoop, TheTipGoesTwiceAsFarAsTheHandAndStopsWithIt) {
  WholeLoop loop(free_space());
  ASSERT_TRUE(loop.engage(5.0));
  const Vec3 begun = loop.cell().rig().true_tip().p;
  loop.lead({10.0 * kMm, 0.0}, 1.0);  // down
  ASSERT_TRUE(loop.pass(4.0));
  const Vec3 way = loop.cell().rig().true_tip().p - begun;
  EXPECT_NEAR(way.z(), -20.0 * kMm, 2.5 * kMm) << "friction holds the hand up to 1 mm off";
  EXPECT_LT(loop.off(), 0.5 * kMm);
  loop.begin_window();
  ASSERT_TRUE(loop.pass(1.0));
  EXPECT_LT(loop.window().hand.peak_to_peak(), 1e-6);
  EXPECT_LT(loop.bounds(), 1.0 + 1e-9);
  EXPECT_GT(loop.bounds(), 0.1);
}

TEST(WholeLoop, AKickIsSeenInItsWindowAndDiesAway) {
  WholeLoop loop(free_space());
  ASSERT_TRUE(loop.engage(5.0));
  loop.begin_window();
  loop.kick({0.5, 0.0});
  ASSERT_TRUE(loop.pass(0.5));
  EXPECT_GT(loop.window().hand.peak_to_peak(), 3.0 * kMm);
  EXPECT_GT(loop.window().tip.peak_to_peak(), 3.0 * kMm);
}

TEST(TeleopCell, AStiffSurfaceAcrossATenthOfASecondIsStableAndStiffByTheModel) {
  TeleopCell cell;
  cell.round_trip = 0.1;
  cell.local = true;
  const TeleopFigures f = measure_teleop(cell, 1);
  EXPECT_TRUE(f.stable());
  EXPECT_GT(f.felt, 700.0);
  EXPECT_GT(f.peak, 0.1) << "the surface was met";
  cell.local = false;
  EXPECT_LT(measure_teleop(cell, 1).felt, 200.0);
}

TEST(TeleopCell, WhatTheSessionRefusesIsNeitherStableNorFailed) {
  TeleopCell cell;
  cell.round_trip = 0.5;
  cell.faults.loss = 0.4;
  const CaseOutcome refused = run_teleop_cell(cell, 1);
  EXPECT_EQ(refused.refused, "refused: the link is not good enough");
  EXPECT_TRUE(refused.figures.empty());
  EXPECT_FALSE(measure_teleop(cell, 1).stable());
  cell.later = true;
  EXPECT_EQ(run_teleop_cell(cell, 1).refused, "");
}

// A way that loses all ends the engagement: the link's doing, not a failure.
TEST(TeleopCell, ALinkThatIsLostMeanwhileIsNotAFailure) {
  TeleopCell cell;
  cell.faults.loss = 1.0;
  cell.later = true;
  EXPECT_NE(run_teleop_cell(cell, 1).refused.find("ended: "), std::string::npos);
}

TEST(TeleopCell, AnotherSeedIsAnotherRunAndTheSameIsTheSame) {
  TeleopCell cell;
  cell.stiffness = 10e3;
  EXPECT_EQ(measure_teleop(cell, 3).felt, measure_teleop(cell, 3).felt);
  EXPECT_NE(measure_teleop(cell, 3).felt, measure_teleop(cell, 4).felt);
}

TEST(ArmCell, AWayThatEndsBeyondAJointsRangeIsHeldWithinIt) {
  ArmWay way;
  way.from << 0.0, 0.35, 1.75, 0.0, 0.87, 3.3;  // J6 ends at 200 degrees, 3.49
  way.turn = forward(ArmGeometry(), way.from).q * Vec3(0.0, 0.0, 0.5);
  const std::map<std::string, double> of = values(run_arm_way(way, 1));
  EXPECT_EQ(of.at("breaches"), 0.0);
  EXPECT_GT(of.at("joint_share"), 0.5) << "the arm moved";
  EXPECT_LE(of.at("joint_share"), 1.0);
  EXPECT_LT(of.at("still_mrad"), 1.0);
}

TEST(LongRun, APartOfADayEndsWhereItBeganAndNothingGrows) {
  const CaseOutcome outcome = run_long({.parts = 4, .part = 10.0, .surface = true}, 1);
  EXPECT_TRUE(all_hold(outcome.figures));
  EXPECT_GT(values(outcome).at("path_m"), 0.05);
}

TEST(LongRun, TheAngleOfTurnsIsTheirSum) {
  const std::map<std::string, double> of = values(run_turns(600.0));
  EXPECT_NEAR(of.at("turns"), 600.0, 1e-9);
  EXPECT_LT(of.at("off_urad"), 1e-3);
  EXPECT_GT(of.at("force_n"), 0.0);
}

TEST(LongRun, CountersNearTheirEndsChangeNothing) {
  LoopCounters counters;
  counters.sequence = (std::uint64_t{1} << 32) - 1000;
  counters.epoch = ~std::uint64_t{0} - 1;
  counters.clock = kForever - 3600 * kSecond;
  const CaseOutcome outcome = run_counters(counters);
  EXPECT_TRUE(all_hold(outcome.figures));
  EXPECT_GT(values(outcome).at("way_mm"), 5.0);
}

TEST(LongRun, AfterTheLastDatagramTheArmStands) {
  EXPECT_TRUE(all_hold(run_last_datagram().figures));
}

}  // namespace
}  // namespace handrail
