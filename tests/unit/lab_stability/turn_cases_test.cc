// The torque of orientation tools, as the suite kicks it.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "server/lab/stability/stability_case.h"

namespace handrail {
namespace {

CaseFigures run_turning(const std::string& name, std::uint64_t seed) {
  for (const StabilityCase& one : turn_cases()) {
    if (one.name == "turning/" + name) return one.run(seed).figures;
  }
  ADD_FAILURE() << name;
  return {};
}

double turning_figure(const CaseFigures& figures, const std::string& name) {
  for (const CaseFigure& f : figures) {
    if (name == f.name) return f.value;
  }
  ADD_FAILURE() << name;
  return 0.0;
}

TEST(TurnCases, EachHasANameOfItsOwnAndMustHoldWithTheGovernor) {
  std::set<std::string> names;
  for (const StabilityCase& one : turn_cases()) {
    EXPECT_TRUE(names.insert(one.name).second) << one.name;
    EXPECT_EQ(one.must_hold, one.name.ends_with("/on")) << one.name;
  }
  EXPECT_EQ(names.size(), 270u);
}

// The damper of the stylus holds 2 b / T = 1 N m/rad.
TEST(TurnCases, AStiffToolMakesEnergyAndTheMasterRendersWhatTheDeviceHolds) {
  EXPECT_TRUE(all_hold(run_turning("none/n_rotation/K0.5/2rad_s/off", 1)));
  EXPECT_GT(turning_figure(run_turning("none/n_rotation/K2/2rad_s/off", 1), "over_mj"), 10.0);
  const CaseFigures governed = run_turning("none/n_rotation/K2/2rad_s/on", 1);
  EXPECT_TRUE(all_hold(governed));
  EXPECT_NEAR(turning_figure(governed, "rendered_n_m_rad"), 0.95, 1e-3);
}

// A torque that came after the hand by its step limit alone turned it round and round.
TEST(TurnCases, ATorqueFollowsAFastStylus) {
  for (const char* name : {"none/n_rotation/K0.5/20rad_s/on", "none/f_rotation/K1/10rad_s/on",
                           "light/f_rotation/K1/20rad_s/on"}) {
    EXPECT_TRUE(all_hold(run_turning(name, 1))) << name;
  }
}

// Stiffer than the device holds, and fast: what is made is taken back all the same.
TEST(TurnCases, WhatItsGovernorTakesBackKeepsAStiffToolFromMakingMore) {
  const CaseFigures off = run_turning("none/n_rotation/K2/2rad_s/off", 1);
  const CaseFigures energy = run_turning("none/n_rotation/K2/2rad_s/energy", 1);
  EXPECT_LT(turning_figure(energy, "given_mj"), 0.1 * turning_figure(off, "given_mj"));
}

}  // namespace
}  // namespace handrail
