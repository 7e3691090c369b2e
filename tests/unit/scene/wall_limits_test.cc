#include "server/scene/wall_limits.h"

#include <gtest/gtest.h>

#include <cmath>

namespace handrail {
namespace {

TEST(WallLimits, TheTightestKnownLimitHolds) {
  // The joystick of devices: a 0.0942 mm step needs 0.24 N of friction and 2.5 N s/m at 1 kHz to
  // hold 5 N/mm.
  WallDevice device;
  EXPECT_TRUE(std::isinf(stiffness_limit(device, 0.0)));
  device.damping = 2.5;
  EXPECT_DOUBLE_EQ(stiffness_limit(device, 0.0), 5000.0);
  EXPECT_DOUBLE_EQ(stiffness_limit(device, 0.5), 4000.0);
  EXPECT_DOUBLE_EQ(stiffness_limit(device, 3.0), 0.0);
  device.period = 0.5e-3;
  EXPECT_DOUBLE_EQ(stiffness_limit(device, 0.0), 10000.0);
  device.friction = 0.24;
  device.resolution = 0.0942e-3;
  EXPECT_NEAR(stiffness_limit(device, 0.0), 5095.5, 0.1);
  device.max_stiffness = 800.0;
  EXPECT_DOUBLE_EQ(stiffness_limit(device, 0.0), 800.0);
}

TEST(WallLimits, WarnsOfWallsTheDeviceCannotHoldAndOfNoOthers) {
  Walls walls;
  for (const double stiffness : {2000.0, 9000.0}) {
    WallRegion region;
    region.name = stiffness > 5000.0 ? "rim" : "mat";
    region.kind = RegionKind::kWall;
    region.stiffness = stiffness;
    walls.regions.push_back(region);
  }
  walls.regions.push_back({});
  WallDevice device;
  EXPECT_TRUE(stiffness_warnings(walls, device).empty());
  device.damping = 2.5;
  EXPECT_EQ(stiffness_warnings(walls, device),
            std::vector<std::string>{
                "wall 'rim': the device holds 5 N/mm, not 9 N/mm: it may buzz under a light hand"});
}

}  // namespace
}  // namespace handrail
