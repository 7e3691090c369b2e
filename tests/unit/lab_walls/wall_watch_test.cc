#include "server/lab/walls/wall_watch.h"

#include <gtest/gtest.h>

#include <cmath>

namespace handrail {
namespace {

// Free above y = 0.
Walls one_wall() {
  Walls walls;
  walls.method = WallMethod::kExact;
  walls.regions.resize(2);
  walls.regions[1].kind = RegionKind::kWall;
  walls.regions[1].stiffness = 1000.0;
  walls.regions[1].damping = 10.0;
  walls.outside = 1;
  WallShape above;
  above.centre = Vec2(0.0, 0.5);
  above.half = Vec2(0.5, 0.5);
  walls.shapes = {above};
  walls.start = above.centre;
  walls.stages.resize(1);
  return walls;
}

// The hand `depth` in a wall below y = 0.
WallTick touching(double depth, double speed_in, double push_in) {
  WallTick tick;
  tick.hand = Vec2(0.0, -depth);
  tick.velocity = Vec2(0.0, -speed_in);
  tick.effort = Vec2(0.0, -push_in);
  tick.wall = tick.device = Vec2(0.0, 1000.0 * depth);
  tick.contact.touching = depth > 0.0;
  tick.contact.normal = Vec2(0.0, 1.0);
  tick.contact.wall = 1;
  return tick;
}

TEST(PenetrationWatch, ComparesDepthWithWhatEnergyAllows) {
  const Walls walls = one_wall();
  PenetrationWatch watch(walls, 2.0);
  WallTick free = touching(0.0, 0.1, 0.0);
  watch.see(free);
  watch.see(touching(0.004, 0.05, 3.0));
  const double rest = 3.0 / 1000.0;
  const double bound = rest + std::sqrt(rest * rest + 2.0 * 0.01 / 1000.0) + 0.1 * 1e-3;
  EXPECT_NEAR(watch.share_of_bound(), 0.004 / bound, 1e-12);
  EXPECT_DOUBLE_EQ(watch.deepest(), 0.004);
}

TEST(PenetrationWatch, WhatOtherEffectsPushCountsAndContactsStandAlone) {
  const Walls walls = one_wall();
  PenetrationWatch watch(walls, 2.0);
  WallTick hard = touching(0.001, 0.0, 5.0);
  hard.device = hard.wall + Vec2(0.0, -2.0);
  watch.see(hard);
  EXPECT_NEAR(watch.share_of_bound(), 0.001 / 0.014, 1e-12);
  watch.see(touching(0.0, 0.0, 0.0));
  // A new contact, pushed by 1 N alone: 2 mm are allowed.
  watch.see(touching(0.0015, 0.0, 1.0));
  EXPECT_NEAR(watch.share_of_bound(), 0.75, 1e-12);
}

TEST(PenetrationWatch, ForgetsContactsOfTheDevicesCounts) {
  const Walls walls = one_wall();
  PenetrationWatch watch(walls, 2.0);
  watch.see(touching(0.5 * PenetrationWatch::kShallow, 0.0, 0.0));
  EXPECT_EQ(watch.share_of_bound(), 0.0);
  EXPECT_GT(watch.deepest(), 0.0);
}

TEST(JunctionWatch, SeesASpikeAtAJunctionAndNowhereElse) {
  const Walls walls = one_wall();
  WallTick spike = touching(0.003, 0.0, 0.0);
  spike.wall = Vec2(0.0, 6.0);
  JunctionWatch here(walls, {Vec2(0.0, 0.0)}, 0.010);
  here.see(spike);
  EXPECT_NEAR(here.ratio(), 6.0 / (3.0 + 1000.0 * kJoystickResolution), 1e-9);
  JunctionWatch elsewhere(walls, {Vec2(0.1, 0.0)}, 0.010);
  elsewhere.see(spike);
  EXPECT_EQ(elsewhere.ratio(), 0.0);
}

TEST(JunctionWatch, TheLocalWallForceHasTheWallsDamperAtTheHandsOwnSpeed) {
  const Walls walls = one_wall();
  JunctionWatch watch(walls, {Vec2(0.0, 0.0)}, 0.010);
  watch.see(touching(0.0, 0.2, 0.0));
  WallTick tick = touching(0.003, 0.1, 0.0);
  tick.wall = Vec2(0.0, 5.0);
  watch.see(tick);
  EXPECT_NEAR(watch.ratio(), 5.0 / (3.0 + 1000.0 * kJoystickResolution + 10.0 * 0.2), 1e-9);
  // A hand that slides along or comes out brings no damper.
  JunctionWatch sliding(walls, {Vec2(0.0, 0.0)}, 0.010);
  tick.velocity = Vec2(0.2, 0.1);
  sliding.see(tick);
  EXPECT_NEAR(sliding.ratio(), 5.0 / (3.0 + 1000.0 * kJoystickResolution), 1e-9);
}

TEST(JunctionWatch, AProxyLeftBehindIsASpike) {
  const Walls walls = one_wall();
  JunctionWatch watch(walls, {Vec2(0.0, 0.0)}, 0.010);
  WallTick tick = touching(0.003, 0.0, 0.0);
  tick.contact.proxy = Vec2(0.004, 0.0);
  tick.wall = Vec2(4.0, 3.0);
  watch.see(tick);
  EXPECT_NEAR(watch.ratio(), 5.0 / (3.0 + 1000.0 * kJoystickResolution), 1e-9);
}

TEST(JunctionWatch, KeepsTheWorstPassage) {
  const Walls walls = one_wall();
  JunctionWatch watch(walls, {Vec2(0.0, 0.0)}, 0.010);
  WallTick spike = touching(0.003, 0.0, 0.0), away = touching(0.0, 0.0, 0.0);
  spike.wall = Vec2(0.0, 6.0);
  away.hand = Vec2(0.1, 0.1);
  watch.see(spike);
  const double worst = watch.ratio();
  watch.see(away);
  // A hard but honest passage does not make up for it.
  watch.see(touching(0.008, 0.0, 0.0));
  EXPECT_EQ(watch.ratio(), worst);
}

TEST(RestWatch, AHandRestsOnceItHasStayed) {
  RestWatch watch;
  WallTick tick;
  for (int i = 0; i <= 1000; ++i) {
    tick.t = 1e-3 * i;
    tick.hand = Vec2(0.1 + (i < 400 ? 1e-4 * i : 0.04), 0.0);
    watch.see(tick);
    // It came within 2 mm of where it stays at t = 0.38.
    EXPECT_TRUE(i > 870 || !watch.rests()) << i;
  }
  EXPECT_TRUE(watch.rests());
}

TEST(GuidanceWatch, CountsTheWayInsideTheAisles) {
  GuidanceWatch watch;
  WallTick tick;
  tick.handle = Vec2(3.0, 4.0);
  for (int i = 0; i <= 4; ++i) {
    tick.hand = Vec2(0.001 * i, 0.0);
    tick.contact.touching = i == 4;
    watch.see(tick);
  }
  EXPECT_NEAR(watch.inside_share(), 0.75, 1e-12);
  EXPECT_DOUBLE_EQ(watch.most_force(), 5.0);
}

}  // namespace
}  // namespace handrail
