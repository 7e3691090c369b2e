#include "server/effects/wall_spring.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/effects/effect_samples.h"

namespace handrail {
namespace {

using test::kTick;
using test::Mass;

const WallRegion kOpenSpace = test::free_region();

// The wall fills x > 0.
EffectInput against(const WallRegion& wall, const Vec2& hand, const Vec2& velocity) {
  EffectInput in = test::at(hand, kOpenSpace);
  in.velocity = velocity;
  in.proxy = Vec2(std::min(hand.x(), 0.0), hand.y());
  in.wall = hand.x() > 0.0 ? &wall : nullptr;
  return in;
}

Vec2 force(const WallRegion& wall, const Vec2& hand, const Vec2& velocity, Plant plant = {}) {
  WallSpring spring(plant);
  EffectTick tick;
  return spring.force(against(wall, hand, velocity), tick);
}

TEST(WallSpring, PushesBackWithStiffnessTimesDepth) {
  const WallRegion wall = test::wall(5000.0);
  EXPECT_TRUE(force(wall, {2e-3, 0.01}, {0.5, 1.0}).isApprox(Vec2(-10.0, 0.0)));
  EXPECT_EQ(force(wall, {-2e-3, 0.01}, {0.5, 1.0}), Vec2(0.0, 0.0));
}

TEST(WallSpring, TheDamperAddsToTheSpringOnTheWayInAndTakesFromItOnTheWayOut) {
  const WallRegion wall = test::wall(5000.0, 20.0);
  Plant heavy;
  heavy.least_mass = 1e9;
  EXPECT_NEAR(force(wall, {2e-3, 0.0}, {0.1, 3.0}, heavy).x(), -10.0 - 2.0, 1e-6);
  EXPECT_NEAR(force(wall, {2e-3, 0.0}, {-0.1, 3.0}, heavy).x(), -10.0 + 2.0, 1e-6);
  EXPECT_EQ(force(wall, {2e-3, 0.0}, {0.1, 3.0}, heavy).y(), 0.0) << "sliding along is free";
}

TEST(WallSpring, NeverPullsTheHandIn) {
  const WallRegion wall = test::wall(5000.0, 100.0);
  EXPECT_EQ(force(wall, {1e-4, 0.0}, {-5.0, 0.0}).norm(), 0.0);
}

TEST(WallSpring, ContactBeginsWithoutAStep) {
  const WallRegion wall = test::wall(5000.0, 50.0);
  EXPECT_LT(force(wall, {1e-6, 0.0}, {1.0, 0.0}).norm(), 0.12);
  EXPECT_GT(force(wall, {0.5e-3, 0.0}, {1.0, 0.0}).norm(), 40.0);
}

TEST(WallSpring, AStifferWallOnTheWayIsMetWithinTwentyMilliseconds) {
  const WallRegion soft = test::wall(1000.0), hard = test::wall(5000.0);
  WallSpring spring{Plant{}};
  EffectTick tick;
  EXPECT_NEAR(spring.force(against(soft, {1e-3, 0.0}, {0.0, 0.0}), tick).x(), -1.0, 1e-12);
  double last = -1.0;
  for (int i = 0; i < 100; ++i) {
    const double f = spring.force(against(hard, {1e-3, 0.0}, {0.0, 0.0}), tick).x();
    EXPECT_LT(std::abs(f - last), 0.21);
    last = f;
  }
  EXPECT_NEAR(last, -5.0, 0.05);
}

// A mass with no friction of its own, held against the wall by 3 N: the damper is far beyond what
// the printed law could hold for a period (B T / m up to 2000).
TEST(WallSpring, AnyDamperOnTheLeastMassSettles) {
  for (const double damping : {20.0, 1000.0, 1e6}) {
    const WallRegion wall = test::wall(2000.0, damping);
    WallSpring spring{Plant{}};
    EffectTick tick;
    Mass mass;
    mass.x = -0.01;
    double late = 0.0, deepest = 0.0;
    for (int i = 0; i < 30'000; ++i) {
      const Vec2 f = spring.force(against(wall, {mass.x, 0.0}, {mass.v, 0.0}), tick);
      mass.step(f.x() + 3.0);
      deepest = std::max(deepest, mass.x);
      if (i > 25'000) late = std::max(late, std::abs(mass.v));
    }
    EXPECT_NEAR(mass.x, 3.0 / 2000.0, 1e-5) << damping;
    EXPECT_LT(late, 1e-4) << damping;
    EXPECT_LT(deepest, 12e-3) << damping;
  }
}

TEST(WallSpring, BouncingGivesBackAtMostWhatCameIn) {
  for (const double damping : {0.0, 20.0, 200.0}) {
    const WallRegion wall = test::wall(5000.0, damping);
    WallSpring spring{Plant{}};
    EffectTick tick;
    Mass mass;
    mass.x = -1e-3;
    mass.v = 0.5;
    const double before = mass.energy();
    while (mass.x > -2e-3) {
      mass.step(spring.force(against(wall, {mass.x, 0.0}, {mass.v, 0.0}), tick).x());
    }
    // A held spring alone gives K T / 2 against half of pi sqrt(K m): 8 % at 5 N/mm and 0.5 kg.
    EXPECT_LT(mass.energy(), before * (damping == 0.0 ? 1.20 : 1.0)) << damping;
  }
}

TEST(WallSpring, ADamperThatAStageChangesComesWithin20Ms) {
  const WallRegion bare = test::wall(5000.0, 0.0), damped = test::wall(5000.0, 40.0);
  Plant heavy;
  heavy.least_mass = 1e9;
  WallSpring spring(heavy);
  const auto push = [&](const WallRegion& wall) {
    EffectTick tick;
    return spring.force(against(wall, {2e-3, 0.0}, {0.1, 0.0}), tick).x();
  };
  EXPECT_NEAR(push(bare), -10.0, 1e-9);
  EXPECT_NEAR(push(damped), -10.0 - 4.0 / 20.0, 1e-6);
  for (int i = 0; i < 400; ++i) (void)push(damped);
  EXPECT_NEAR(push(damped), -14.0, 1e-5);
}

TEST(WallSpring, ThePublishedDamperIsTheEquationToTheLetter) {
  const WallRegion wall = test::wall(5000.0, 20.0);
  EffectSpec e;
  e.published_damper = true;
  Plant light;
  light.least_mass = 0.05;
  const auto push = [&](const Vec2& hand, const Vec2& velocity) {
    WallSpring spring(e, light);
    EffectTick tick;
    return spring.force(against(wall, hand, velocity), tick);
  };
  // f = K (x_nsp - x) - B x'  (2.1): along the wall too, at the surface too, pulling in on the way
  // out, with all of B.
  EXPECT_TRUE(push({2e-3, 0.0}, {0.1, 0.3}).isApprox(Vec2(-12.0, -6.0)));
  EXPECT_TRUE(push({1e-6, 0.0}, {0.1, 0.0}).isApprox(Vec2(-2.005, 0.0)));
  EXPECT_TRUE(push({1e-3, 0.0}, {-0.5, 0.0}).isApprox(Vec2(5.0, 0.0)));
  EXPECT_EQ(push({-1e-3, 0.0}, {0.5, 0.0}), Vec2(0.0, 0.0)) << "no wall, no damper";
}

}  // namespace
}  // namespace handrail
