#include "server/master/governing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include <cmath>

#include "devices/joystick/joystick_data.h"
#include "devices/omni/omni_data.h"
#include "server/master/haptic_settings.h"
#include "server/master/wall_runs.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

using testing::HasSubstr;

Scene walled(double stiffness) {
  Scene scene;
  auto walls = std::make_shared<Walls>();
  walls->method = WallMethod::kExact;
  walls->regions.resize(2);
  walls->regions[1].name = "brick";
  walls->regions[1].kind = RegionKind::kWall;
  walls->regions[1].stiffness = stiffness;
  WallShape room;
  room.half = Vec2(0.02, 0.02);
  walls->shapes = {room};
  walls->outside = 1;
  walls->stages = {WallStage()};
  scene.walls = walls;
  scene.effects.resize(1);  // the walls'
  return scene;
}

TEST(Governing, ADeviceThatMakesNoForceHasNothingToGovern) {
  HapticCapabilities device;
  device.name = "cap";
  const auto checked = check_renderings(walled(1e6), device);
  EXPECT_TRUE(checked.empty());
  EXPECT_EQ(governed_share(checked), 1.0);
  EXPECT_FALSE(governor_settings(device, true).on);
  device.max_force = 3.3;
  EXPECT_TRUE(governor_settings(device, true).on);
}

TEST(Governing, WhatIsShippedIsRenderedAsItWasPublished) {
  const SceneLibrary library;
  for (const auto& [name, file] : library.list()) {
    const auto scene = library.load(name);
    ASSERT_TRUE(scene) << name;
    const HapticCapabilities device =
        scene->walls ? joystick_capabilities() : omni_capabilities(false);
    const auto checked = check_renderings(*scene, device);
    ASSERT_FALSE(checked.empty()) << name;
    EXPECT_EQ(governed_share(checked), 1.0) << name;
    EXPECT_TRUE(stability_warnings(checked, device, true).empty()) << name;
  }
}

TEST(Governing, AWallThatTheDeviceCannotHoldIsRenderedSofterAndSaysSo) {
  const Scene scene = walled(40e3);
  const HapticCapabilities device = joystick_capabilities();
  const auto checked = check_renderings(scene, device);
  const double share = governed_share(checked);
  EXPECT_LT(share, 0.9);
  EXPECT_GT(share, 0.0);
  EXPECT_EQ(make_wall_run(scene, device, true)->settings.share, share);
  EXPECT_EQ(make_wall_run(scene, device, false)->settings.share, 1.0);
  const auto governed = stability_warnings(checked, device, true);
  ASSERT_EQ(governed.size(), 1u);
  EXPECT_THAT(governed[0], HasSubstr("'brick': 40 N/mm"));
  EXPECT_THAT(governed[0], HasSubstr("rendered at"));
  const auto left = stability_warnings(checked, device, false);
  ASSERT_EQ(left.size(), 1u);
  EXPECT_THAT(left[0], HasSubstr("may buzz"));
}

// A wall that the device holds comes down with the one that it does not hold, and is said to.
TEST(Governing, WhatIsSaidOfEachWallIsWhatIsRendered) {
  Scene scene = walled(5e3);
  auto walls = std::make_shared<Walls>(*scene.walls);
  walls->regions.push_back(walls->regions[1]);
  walls->regions[2].name = "steel";
  walls->regions[2].stiffness = 50e3;
  scene.walls = walls;
  const HapticCapabilities device = joystick_capabilities();
  const auto checked = check_renderings(scene, device);
  const double share = make_wall_run(scene, device, true)->settings.share;
  ASSERT_LT(share, 0.2);
  for (const CheckedRendering& c : checked) EXPECT_EQ(c.share, share) << c.rendering.name;
  EXPECT_GT(checked[0].margin.share, 1.0);
  const auto lines = stability_lines(checked, device, true);
  EXPECT_THAT(lines[1], HasSubstr("'brick': 5 N/mm; "));
  EXPECT_THAT(lines[1], HasSubstr("; rendered at 0.605 N/mm, as all come down together"));
  EXPECT_THAT(lines[2], testing::EndsWith("; rendered at 6.05 N/mm"));
  const auto warnings = stability_warnings(checked, device, true);
  ASSERT_EQ(warnings.size(), checked.size());
  EXPECT_THAT(warnings[0], HasSubstr("'brick'"));
  EXPECT_EQ(stability_warnings(checked, device, false).size(), checked.size() - 1);
}

// A damper that the device does not hold comes down; then it holds more of the spring.
TEST(Governing, WhatIsSaidOfADampedToolIsWhatIsRendered) {
  const HapticCapabilities device = omni_capabilities(false);
  for (const double stiffness : {0.0, 10e3}) {
    Scene scene;
    scene.guidance.stiffness = stiffness;
    scene.guidance.damping = 100.0;
    const HapticSettings run = haptic_settings(scene, device, true);
    const auto checked = check_renderings(scene, device);
    const CheckedRendering& tools = checked.front();
    EXPECT_LT(run.damping, 95.0);
    EXPECT_NEAR(tools.damping_share * 100.0, run.damping, 1e-9) << stiffness;
    EXPECT_NEAR(tools.share * stiffness, std::min(stiffness, run.guide.most_stiffness), 1e-6);
    EXPECT_THAT(
        stability_lines(checked, device, true)[1],
        HasSubstr(fmt::format("rendered at {:.3g} N/mm, {:.3g} N s/m",
                              1e-3 * std::min(stiffness, run.guide.most_stiffness), run.damping)));
    EXPECT_EQ(stability_warnings(checked, device, true).size(), 1u) << stiffness;
  }
}

// The governor keeps a twentieth away from the limit, and says so.
TEST(Governing, WhatIsALittleSofterThanAskedForIsSaidToo) {
  const HapticCapabilities device = joystick_capabilities();
  const double held = check_renderings(walled(1e3), device)[0].margin.share * 1e3;
  const auto checked = check_renderings(walled(0.98 * held), device);
  EXPECT_LT(make_wall_run(walled(0.98 * held), device, true)->settings.share, 1.0);
  EXPECT_EQ(stability_warnings(checked, device, true).size(), 1u);
  EXPECT_TRUE(stability_warnings(checked, device, false).empty());
}

TEST(Governing, NoToolIsStifferThanTheDeviceHolds) {
  Scene scene;
  const HapticCapabilities device = omni_capabilities(false);
  const HapticSettings governed = haptic_settings(scene, device, true);
  EXPECT_GT(governed.guide.most_stiffness, scene.guidance.stiffness);
  EXPECT_LT(governed.guide.most_stiffness, 2000.0);
  EXPECT_TRUE(governed.governor.on);
  EXPECT_EQ(governed.governor.friction, kOmniFriction);
  EXPECT_FALSE(haptic_settings(scene, device).governor.on);
  EXPECT_GT(haptic_settings(scene, device).guide.most_stiffness, 1e6);
}

// Nothing damps it without a tool, and along a slanted one that tool's damper does.
TEST(Governing, WhatIsSaidOfASurfaceThatIsTouchedIsWhatIsRendered) {
  HapticCapabilities device = omni_capabilities(false);
  device.dynamics.friction = 0.0;
  device.dynamics.damping = 0.5;
  Scene scene;
  EXPECT_EQ(haptic_settings(scene, device, true).surface_stiffness, 0.0) << "it is off";
  EXPECT_EQ(check_renderings(scene, device).size(), 2u);
  scene.guidance.local_surface = true;
  scene.guidance.stiffness = 5e3;
  EXPECT_EQ(haptic_settings(scene, device, false).surface_stiffness, 5e3);
  scene.guidance.stiffness = 0.0;
  EXPECT_EQ(haptic_settings(scene, device, true).surface_stiffness, 0.0) << "nor is a tool felt";
  scene.guidance.stiffness = 5e3;
  HapticCapabilities unknown = device;
  unknown.dynamics = DeviceDynamics();
  EXPECT_EQ(haptic_settings(scene, unknown, true).surface_stiffness, 0.0) << "the spring stays";
  for (const double damping : {0.0, 5.0, 100.0}) {
    scene.guidance.damping = damping;
    const HapticSettings run = haptic_settings(scene, device, true);
    EXPECT_LE(run.surface_stiffness, run.guide.most_stiffness) << damping;
    EXPECT_LE(run.surface_stiffness,
              kGoverned * most_stiffness(device.dynamics, rendering_loop(device), 0.0));
    EXPECT_GT(run.surface_stiffness, 100.0) << damping;
    const auto checked = check_renderings(scene, device);
    ASSERT_EQ(checked.size(), 3u);
    EXPECT_NEAR(checked[2].share * 5e3, run.surface_stiffness, 1e-6) << damping;
    EXPECT_NEAR(governed_share(checked) * damping, run.damping, 1e-9) << damping;
    EXPECT_THAT(stability_lines(checked, device, true)[3],
                HasSubstr(fmt::format("surface that is touched: 5 N/mm; {} holds", device.name)));
    EXPECT_THAT(stability_lines(checked, device, true)[3],
                HasSubstr(fmt::format("rendered at {:.3g} N/mm", 1e-3 * run.surface_stiffness)));
  }
}

TEST(Governing, ADeviceThatDeclaresNothingIsRenderedNothing) {
  HapticCapabilities unknown = joystick_capabilities();
  unknown.dynamics = DeviceDynamics();
  EXPECT_EQ(make_wall_run(walled(1000.0), unknown, true)->settings.share, 0.0);
  const auto warnings =
      stability_warnings(check_renderings(walled(1000.0), unknown), unknown, true);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_THAT(warnings[0], HasSubstr("mass not declared"));
  EXPECT_EQ(governor_settings(unknown, true).friction, 0.0);
}

// What it takes up is not known; when a force acts is.
TEST(Governing, ADevicesDelayCountsWhateverElseIsNotDeclared) {
  HapticCapabilities device = joystick_capabilities();
  device.dynamics.delay = 3.25e-3;
  for (double* unknown : {&device.dynamics.mass, &device.dynamics.resolution}) {
    *unknown = 0.0;
    EXPECT_EQ(governor_settings(device, true).delay, 3);
    EXPECT_NEAR(governor_settings(device, true).late, 0.25, 1e-9);
    EXPECT_EQ(governor_settings(device, true).friction, 0.0);
    EXPECT_EQ(governor_settings(device, true).damping, 0.0);
  }
}

TEST(Governing, ADevicesDelayLetsItHoldLessAndOneThatIsNoneNothing) {
  HapticCapabilities device = joystick_capabilities();
  const auto share = [&] { return check_renderings(walled(5000.0), device)[0].margin.share; };
  const double at_once = share();
  device.dynamics.delay = 2e-3;
  EXPECT_LT(share(), 0.3 * at_once);  // T / 2 + d: a fifth, by what is passive
  EXPECT_EQ(governor_settings(device, true).delay, 2);
  EXPECT_GT(governor_settings(device, true).friction, 0.0);
  device.dynamics.delay = 1.35e-3;
  EXPECT_EQ(governor_settings(device, true).delay, 1);
  EXPECT_NEAR(governor_settings(device, true).late, 0.35, 1e-9);
  for (const double none : {-1e-3, std::nan(""), 1.0}) {
    device.dynamics.delay = none;
    EXPECT_EQ(share() == 0.0, !(none > 0.0)) << none;
    EXPECT_EQ(governor_settings(device, true).delay, 0) << none;
    EXPECT_EQ(governor_settings(device, true).friction, 0.0) << none;
  }
  EXPECT_THAT(stability_lines(check_renderings(walled(5000.0), device), device, true)[0],
              HasSubstr("delay 1000 ms (resolution as published"));
}

TEST(Governing, TheSpringToTheTipKeepsItsStiffnessAndIsBounded) {
  Scene scene;
  const auto checked = check_renderings(scene, omni_capabilities(false));
  const CheckedRendering& spring = checked.back();
  EXPECT_TRUE(spring.bounded);
  EXPECT_LT(spring.margin.share, 1.0) << "100 ms late, without damping of the device";
  EXPECT_EQ(spring.share, 1.0);
  EXPECT_THAT(stability_lines(checked, omni_capabilities(false), true).back(),
              HasSubstr("energy bounded"));
}

// Without friction a held spring needs b >= K T / 2: 1 N m/rad, and a little more with inertia.
TEST(Governing, ATorqueIsRenderedNoStifferThanItsDeviceHolds) {
  HapticCapabilities device = omni_capabilities(true);
  Scene scene;
  scene.guidance.torque_stiffness = 5.0;
  ToolCall& own = scene.tools.emplace_back();
  own.kind = ToolKind::kFRotation;
  own.stiffness = 0.25;
  const auto checked = check_renderings(scene, device);
  ASSERT_EQ(checked.size(), 4u);
  EXPECT_TRUE(checked[2].rendering.turns && checked[3].rendering.turns);
  EXPECT_NEAR(checked[2].margin.share, 1.0 / 5.0, 1e-3);
  EXPECT_NEAR(checked[3].margin.share, 1.0 / 0.25, 1e-2);
  EXPECT_EQ(checked[3].share, 1.0);
  EXPECT_EQ(governed_share(checked), 1.0) << "of forces";
  const std::vector<std::string> lines = stability_lines(checked, device, true);
  EXPECT_THAT(lines[1], HasSubstr("turned: inertia 8.44e-05 kg m^2, damping 0.0005 N m s/rad"));
  EXPECT_THAT(lines[4], HasSubstr("orientation tools: 5 N m/rad"));
  EXPECT_THAT(lines[4], HasSubstr("rendered at 0.95"));
  EXPECT_THAT(lines[5], HasSubstr("'f-rotation': 0.25 N m/rad"));
  EXPECT_THAT(stability_warnings(checked, device, false)[0], HasSubstr("it may buzz"));
  EXPECT_NEAR(haptic_settings(scene, device, true).guide.most_torque_stiffness, 0.95, 1e-3);
  EXPECT_GT(haptic_settings(scene, device, false).guide.most_torque_stiffness, 1e6);
  EXPECT_TRUE(haptic_settings(scene, device, true).turn_governor.on);
  EXPECT_EQ(haptic_settings(scene, device, true).turn_governor.peak, kOmniTorque);
  EXPECT_FALSE(haptic_settings(scene, omni_capabilities(false), true).turn_governor.on);
  // Nothing is known of how it turns: nothing that could be held is shown to be.
  device.turning = DeviceDynamics();
  EXPECT_EQ(check_renderings(scene, device)[2].share, 0.0);
  EXPECT_EQ(haptic_settings(scene, device, true).guide.most_torque_stiffness, 0.0);
}

}  // namespace
}  // namespace handrail
