// Which stage of the walls is in force.
#include "server/haptic/stage_watch.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/unit/haptic/wall_rig.h"

namespace handrail {
namespace {

using test::effect;
using test::WallRig;
using Kind = StageCondition::Kind;

Walls walls_with(std::vector<StageCondition> conditions) {
  Walls out;
  for (const StageCondition& when : conditions) out.stages.emplace_back().when = when;
  return out;
}

// The stage after each of `count` ticks in which nothing but `signs` is seen.
int after_ticks(StageWatch& watch, const Walls& walls, const StageSigns& signs, int count,
                int ordered = 0, std::uint32_t orders = 0) {
  for (int i = 0; i < count; ++i) {
    (void)watch.now(walls, ordered, orders, 1e-3);
    watch.see(walls, signs);
  }
  return watch.stage();
}

TEST(StageWatch, BeginsWithTheOneOrderedAndFollowsOrdersAtOnce) {
  const Walls walls = walls_with({{}, {}, {}});
  StageWatch watch;
  EXPECT_EQ(watch.stage(), -1);
  EXPECT_EQ(watch.now(walls, 0, 0, 1e-3), 0);
  EXPECT_EQ(watch.now(walls, 2, 1, 1e-3), 2);
  EXPECT_EQ(watch.now(walls, 1, 2, 1e-3), 1);
  EXPECT_EQ(watch.now(walls, 99, 3, 1e-3), 2);
  EXPECT_EQ(watch.now(walls, -5, 4, 1e-3), 0);
}

TEST(StageWatch, AConditionLeadsThereWhenItBecomesTrueAndNotAgainWhileItIs) {
  const Walls walls = walls_with({{}, {Kind::kLocked, 3, 0.0}});
  StageWatch watch;
  EXPECT_EQ(after_ticks(watch, walls, {}, 200), 0);
  StageSigns locked;
  locked.place = 3;
  EXPECT_EQ(after_ticks(watch, walls, locked, 2), 1);
  // Who orders the first one again has it, though the lever still is in that gear.
  EXPECT_EQ(after_ticks(watch, walls, locked, 500, 0, 1), 0);
  EXPECT_EQ(after_ticks(watch, walls, {}, 2, 0, 1), 0);
  EXPECT_EQ(after_ticks(watch, walls, locked, 200, 0, 1), 1) << "it has become true again";
}

TEST(StageWatch, TurningPastAnAngleAndBackWithRoomBetween) {
  const Walls walls = walls_with({{Kind::kTurnedUnder, 0, 1.0}, {Kind::kTurnedOver, 0, 2.0}});
  StageWatch watch;
  const auto turned = [&](double angle) {
    StageSigns signs;
    signs.turned = angle;
    return after_ticks(watch, walls, signs, 150);
  };
  EXPECT_EQ(turned(0.0), 0);
  EXPECT_EQ(turned(1.9), 0);
  EXPECT_EQ(turned(2.1), 1);
  EXPECT_EQ(turned(1.5), 1);
  EXPECT_EQ(turned(0.9), 0);
  EXPECT_EQ(turned(1.5), 0);
}

TEST(StageWatch, ARegionLeadsOn) {
  const Walls walls = walls_with({{}, {Kind::kInside, 2, 0.0}, {Kind::kUnlocked, 1, 0.0}});
  StageWatch watch;
  StageSigns in_gear;
  in_gear.place = 1;
  EXPECT_EQ(after_ticks(watch, walls, in_gear, 200), 0);
  StageSigns there = in_gear;
  there.region = 2;
  EXPECT_EQ(after_ticks(watch, walls, there, 2), 1);
  there.place = -1;
  EXPECT_EQ(after_ticks(watch, walls, there, 200), 2);
}

TEST(StageWatch, StagesThatLeadToEachOtherChangeTenTimesASecondAtMost) {
  const Walls walls = walls_with({{Kind::kInside, 0, 0.0}, {Kind::kInside, 1, 0.0}});
  StageWatch watch;
  int changes = 0, last = -1;
  for (int i = 0; i < 1000; ++i) {
    StageSigns signs;
    signs.region = static_cast<std::uint8_t>(i % 2);
    const int now = after_ticks(watch, walls, signs, 1);
    changes += now != last ? 1 : 0;
    last = now;
  }
  EXPECT_LE(changes, 11);
  EXPECT_GE(changes, 5);
}

TEST(StageWatch, OfSeveralTheLastListedCounts) {
  const Walls walls = walls_with({{}, {Kind::kInside, 1, 0.0}, {Kind::kTurnedOver, 0, 1.0}});
  StageWatch watch;
  EXPECT_EQ(after_ticks(watch, walls, {}, 200), 0);
  StageSigns both;
  both.region = 1;
  both.turned = 2.0;
  EXPECT_EQ(after_ticks(watch, walls, both, 2), 2);
}

// ---- among walls

std::vector<WallRegion> with_stiffness(const WallRig& rig, double stiffness) {
  std::vector<WallRegion> out = rig.walls->regions;
  out[1].stiffness = stiffness;
  return out;
}

// The hand goes slowly to x, y.
void go(WallRig& rig, const Vec2& to) {
  while (true) {
    const Vec2 left = to - rig.in.hand.X_MH.p.head<2>();
    if (left.norm() < 1e-9) return;
    (void)rig.move(rig.in.hand.X_MH.p.head<2>() + std::min(1.0, 1e-4 / left.norm()) * left);
  }
}

TEST(StageOfWalls, AWallHardensUnderThePressingHandInBoundedSteps) {
  WallRig rig;
  rig.walls->stages[1].regions = with_stiffness(rig, 1000.0);
  rig.move({-0.01, 0.02});
  go(rig, {3e-3, 0.02});
  ASSERT_NEAR(rig.out.f_H_M.force.x(), -15.0, 1e-6);
  rig.in.stage = 1;
  double last = -15.0;
  for (int i = 0; i < 400; ++i) {
    const double now = rig.move({3e-3, 0.02}).x();
    ASSERT_LE(std::abs(now - last), rig.settings.force.step + 1e-9);
    last = now;
  }
  EXPECT_NEAR(last, -3.0, 1e-3);
  rig.in.stage = 0;
  for (int i = 0; i < 400; ++i) {
    const double now = rig.move({3e-3, 0.02}).x();
    ASSERT_LE(std::abs(now - last), rig.settings.force.step + 1e-9);
    last = now;
  }
  EXPECT_NEAR(last, -15.0, 1e-3);
}

TEST(StageOfWalls, AnAisleBecomesTougherByItsStage) {
  WallRig rig({effect(EffectKind::kViscous)});
  rig.walls->stages[1].regions = rig.walls->regions;
  rig.walls->stages[1].regions[2].viscosity = 60.0;
  const auto drag = [&] {
    // 0.05 m/s along the aisle for 0.3 s; the drag at the end.
    double f = 0.0;
    rig.move({-0.02, -0.02});
    for (int i = 0; i < 300; ++i) f = rig.move({-0.02 + 5e-5 * i, -0.02}).x();
    return f;
  };
  EXPECT_NEAR(drag(), -20.0 * 0.05, 0.02);
  rig.in.stage = 1;
  EXPECT_NEAR(drag(), -60.0 * 0.05, 0.05);
}

TEST(StageOfWalls, ADetentGoesAndComesBackWithItsLock) {
  EffectSpec gears = effect(EffectKind::kDetent);
  gears.places = {Vec2(-0.02, 0.01)};
  gears.radius = 8e-3;
  gears.peak = 4.0;
  WallRig rig({gears});
  rig.walls->stages[1].detent_peaks = {0.0};
  rig.move({-0.04, 0.01});
  go(rig, {-0.018, 0.01});
  rig.move({-0.018, 0.01});  // at rest
  EXPECT_NEAR(rig.out.f_H_M.force.x(), -2.0, 1e-6);
  EXPECT_TRUE(rig.out.effects.locked);
  rig.in.stage = 1;
  for (int i = 0; i < 600; ++i) rig.move({-0.018, 0.01});
  EXPECT_EQ(rig.out.f_H_M.force.x(), 0.0);
  EXPECT_FALSE(rig.out.effects.locked);
  rig.in.stage = 0;
  for (int i = 0; i < 600; ++i) rig.move({-0.018, 0.01});
  EXPECT_NEAR(rig.out.f_H_M.force.x(), -2.0, 1e-6);
  EXPECT_TRUE(rig.out.effects.locked);
}

TEST(StageOfWalls, TheScrewsProgressHardensTheWall) {
  EffectSpec turn = effect(EffectKind::kProgressive);
  turn.c = 0.0;
  turn.at = Vec2(-0.03, -0.03);
  turn.clockwise = false;
  WallRig rig({effect(EffectKind::kWall), turn});
  rig.walls->stages[1].when = {Kind::kTurnedOver, 0, 1.5 * std::numbers::pi};
  rig.walls->stages[1].regions = with_stiffness(rig, 1000.0);
  // Round the centre in the aisle, where turning counts.
  const auto on_circle = [](double angle) {
    return Vec2(-0.03 + 0.02 * std::cos(angle), -0.03 + 0.02 * std::sin(angle));
  };
  double angle = 0.0;
  rig.move(on_circle(0.0));
  for (; angle < 1.4 * std::numbers::pi; angle += 0.005) rig.move(on_circle(angle));
  EXPECT_EQ(rig.out.stage, 0);
  for (; angle < 1.6 * std::numbers::pi; angle += 0.005) rig.move(on_circle(angle));
  EXPECT_EQ(rig.out.stage, 1);
  go(rig, {3e-3, -0.03});
  EXPECT_NEAR(rig.out.f_H_M.force.x(), -3.0, 1e-3);
}

}  // namespace
}  // namespace handrail
