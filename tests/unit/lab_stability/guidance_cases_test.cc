// The force of position tools and of a surface, as the suite kicks it.
#include <gtest/gtest.h>

#include <cstdint>
#include <set>
#include <string>

#include "server/lab/stability/stability_case.h"

namespace handrail {
namespace {

bool guidance_holds(const std::string& name, std::uint64_t seed = 1) {
  for (const StabilityCase& one : guidance_cases()) {
    if (one.name == "guidance/" + name) return all_hold(one.run(seed).figures);
  }
  ADD_FAILURE() << name;
  return false;
}

TEST(GuidanceCases, EachHasANameOfItsOwnAndMustHoldWithTheGovernor) {
  std::set<std::string> names;
  for (const StabilityCase& one : guidance_cases()) {
    EXPECT_TRUE(names.insert(one.name).second) << one.name;
    EXPECT_EQ(one.must_hold, one.name.ends_with("/on")) << one.name;
  }
  EXPECT_EQ(names.size(), 2592u);
}

// The linear axis takes up 2 b / T = 1 N/mm by itself.
TEST(GuidanceCases, AStiffToolMakesEnergyAndTheMasterRendersWhatTheDeviceHolds) {
  EXPECT_TRUE(guidance_holds("linear/light/line/K0.1/off"));
  EXPECT_FALSE(guidance_holds("linear/none/line/K10/off"));
  EXPECT_TRUE(guidance_holds("linear/none/line/K10/on"));
}

// All of a surface's push beside a slanted line made energy on each way around.
TEST(GuidanceCases, ASurfaceBesideASlantedLineMakesNone) {
  for (const char* name :
       {"joystick/none/line60+surface/K10/on", "joystick/light/line60+surface/K10/on",
        "linear/none/line30+surface/K1.5/on", "linear/none/line60+surface/K0.8/on",
        "linear/none/line60+surface/K0.8/delay5ms/on", "linear/light/line60+surface/K0.8/on"}) {
    EXPECT_TRUE(guidance_holds(name)) << name;
  }
}

// The device's damping was counted for the tool and once more for the spring to the tip: 1.17 mJ.
TEST(GuidanceCases, WhatTheDeviceTakesIsCountedOnceForToolAndSpring) {
  EXPECT_TRUE(guidance_holds("linear/none/line60+surface/K10/delay1ms/on", 887281));
}

// A damper that came after the hand by its step limit alone made up to 92 mJ.
TEST(GuidanceCases, ADampersForceComesWithTheHand) {
  for (const char* name :
       {"omni/none/point+surface+damper/K0.8/on", "joystick/none/line+damper/K10/on",
        "linear/light/point+surface+damper/K10/on"}) {
    EXPECT_TRUE(guidance_holds(name)) << name;
  }
}

}  // namespace
}  // namespace handrail
