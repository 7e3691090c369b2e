// What the slave takes from a scene.
#include "server/slave/follow_settings.h"

#include <gtest/gtest.h>

#include "server/base/units.h"

namespace handrail {
namespace {

TEST(FollowSettings, TheCatchUpIsTheScenes) {
  Scene scene;
  scene.guidance.catch_up = 0.012;
  scene.guidance.catch_up_rotation = 3.0 * kDeg;
  const FollowSettings settings = follow_settings(scene, 7'100'000, true, 1000.0);
  EXPECT_EQ(settings.catch_up, 0.012);
  EXPECT_EQ(settings.catch_up_rotation, 3.0 * kDeg);
}

}  // namespace
}  // namespace handrail
