// The drags: viscous aisle, progressive friction, Coulomb friction, one-way aisle.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/effects/coulomb_friction.h"
#include "server/effects/one_way_aisle.h"
#include "server/effects/progressive_friction.h"
#include "server/effects/viscous_aisle.h"
#include "tests/unit/effects/effect_samples.h"

namespace handrail {
namespace {

using std::numbers::pi;
using test::kTick;
using test::Mass;

constexpr double kRadius = 0.05;

Vec2 on_circle(double angle) { return {kRadius * std::cos(angle), kRadius * std::sin(angle)}; }

// Goes round the origin from `from` to `to` at `speed`; the last force.
template <typename Effect>
Vec2 go_round(Effect& effect, const WallRegion& region, double from, double to, double speed) {
  EffectTick tick;
  const int ticks = static_cast<int>(std::abs(to - from) * kRadius / speed / kTick);
  Vec2 f = Vec2::Zero();
  for (int i = 0; i <= ticks; ++i) {
    f = effect.force(test::at(on_circle(from + (to - from) * i / ticks), region), tick);
  }
  return f;
}

TEST(ViscousAisle, DragsAgainstTheMotionByTheRegionsViscosity) {
  const WallRegion region = test::aisle(30.0);
  ViscousAisle aisle(2500.0, Plant{});
  EffectTick tick;
  Vec2 f = Vec2::Zero();
  for (int i = 0; i < 400; ++i) f = aisle.force(test::at({0.05, i * 1e-4}, region), tick);
  EXPECT_NEAR(f.x(), 0.0, 1e-12);
  EXPECT_NEAR(f.y(), -30.0 * 0.1, 1e-3);
}

TEST(ViscousAisle, EnteringFarFromTheOriginBeginsAtNoForce) {
  const WallRegion outside = test::aisle(0.0), inside = test::aisle(200.0);
  ViscousAisle aisle(2500.0, Plant{});
  EffectTick tick;
  EXPECT_EQ(aisle.force(test::at({0.09, 0.0}, outside), tick).norm(), 0.0);
  EXPECT_EQ(aisle.force(test::at({0.09, 0.0}, inside), tick).norm(), 0.0);
  double last = 0.0;
  for (int i = 1; i < 1000; ++i) {
    const bool in = i < 500;
    const Vec2 f = aisle.force(test::at({0.09, i * 1e-4}, in ? inside : outside), tick);
    EXPECT_LT(std::abs(f.norm() - last), 1.3) << i;
    last = f.norm();
  }
  EXPECT_EQ(last, 0.0);
}

TEST(ProgressiveFriction, CountsTheAngleTurnedAndTakesItBackTheOtherWay) {
  const WallRegion region = test::aisle(0.0, true);
  ProgressiveFriction friction(5.0, Vec2::Zero(), true, 2500.0, Plant{});
  go_round(friction, region, 0.0, -4.0 * pi, 0.5);
  EXPECT_NEAR(friction.alpha(), 4.0 * pi, 1e-9);
  EXPECT_NEAR(friction.viscosity(), 5.0 * 4.0 * pi, 1e-8);
  go_round(friction, region, 0.0, pi, 0.5);
  EXPECT_NEAR(friction.alpha(), 3.0 * pi, 1e-9);
  go_round(friction, region, pi, 5.0 * pi, 0.5);
  EXPECT_NEAR(friction.alpha(), -pi, 1e-9);
  EXPECT_EQ(friction.viscosity(), 0.0);
}

TEST(ProgressiveFriction, TheOtherHandTightensTheOtherWay) {
  const WallRegion region = test::aisle(0.0, true);
  ProgressiveFriction friction(5.0, Vec2::Zero(), false, 2500.0, Plant{});
  go_round(friction, region, 0.0, pi, 0.5);
  EXPECT_NEAR(friction.alpha(), pi, 1e-9);
}

TEST(ProgressiveFriction, OnlyTurnsTheScrewInItsOwnAisle) {
  const WallRegion turning = test::aisle(0.0, true), back = test::aisle();
  ProgressiveFriction friction(5.0, Vec2::Zero(), true, 2500.0, Plant{});
  go_round(friction, turning, pi, 0.0, 0.5);
  const Vec2 f = go_round(friction, back, 0.0, pi, 0.5);
  EXPECT_NEAR(friction.alpha(), pi, 1e-9);
  EXPECT_EQ(f.norm(), 0.0);
  go_round(friction, turning, pi, 0.0, 0.5);
  EXPECT_NEAR(friction.alpha(), 2.0 * pi, 1e-9);
}

TEST(ProgressiveFriction, DragsWithCAlphaAgainstTheMotion) {
  const WallRegion region = test::aisle(0.0, true);
  const double speed = 0.05;
  ProgressiveFriction friction(15.0, Vec2::Zero(), true, 2500.0, Plant{});
  const Vec2 f = go_round(friction, region, 0.0, -2.0 * pi, speed);
  // B grows while the slider lags by B / k: the force is of a little earlier.
  const double b = 15.0 * 2.0 * pi;
  const double lag = b / 2500.0;
  const double expected = (b - 15.0 * speed / kRadius * lag) * speed;
  EXPECT_NEAR(f.norm(), expected, 0.02 * expected);
  EXPECT_NEAR(std::atan2(f.y(), f.x()), pi / 2.0, lag * speed / kRadius + 0.01);
}

TEST(ProgressiveFriction, COrderedIsComeToInSteps) {
  const WallRegion region = test::aisle(0.0, true);
  ProgressiveFriction friction(5.0, Vec2::Zero(), true, 2500.0, Plant{});
  EffectTick tick;
  EffectInput in = test::at(on_circle(0.0), region);
  friction.force(in, tick);
  EXPECT_EQ(friction.c(), 5.0) << "nothing is ordered";
  in.screw_c = 15.0;
  double before = friction.c();
  int ticks = 0;
  for (; friction.c() < 15.0 && ticks < 10'000; ++ticks) {
    friction.force(in, tick);
    EXPECT_LE(friction.c() - before, ProgressiveFriction::kMostChange * test::kTick + 1e-12);
    before = friction.c();
  }
  EXPECT_NEAR(ticks, 500, 1);
  EXPECT_EQ(friction.c(), 15.0);
  in.screw_c = 0.0;
  for (int i = 0; i < 1000; ++i) friction.force(in, tick);
  EXPECT_EQ(friction.c(), 0.0);
}

// A hand of 0.5 kg that pushes along the circle: the printed law is unstable over B T / m = 2,
// which c = 500 passes within a third of a radian.
TEST(ProgressiveFriction, AnyCSlowsTheHandDownWithoutThrowingItBack) {
  for (const double c : {5.0, 15.0, 500.0, 1e5}) {
    const WallRegion region = test::aisle(0.0, true);
    ProgressiveFriction friction(c, Vec2::Zero(), true, 2500.0, Plant{});
    go_round(friction, region, 0.0, -2.0 * pi, 0.5);
    friction.restart(on_circle(0.0));
    Mass along;  // way along the circle, clockwise
    along.v = 0.5;
    EffectTick tick;
    double late = 0.0, fastest = 0.0;
    for (int i = 0; i < 60'000; ++i) {
      const double a = -along.x / kRadius;
      const Vec2 f = friction.force(test::at(on_circle(a), region), tick);
      along.step(f.dot(Vec2(std::sin(a), -std::cos(a))));
      fastest = std::max(fastest, std::abs(along.v));
      if (i > 55'000) late = std::max(late, std::abs(along.v));
      ASSERT_LE(f.norm(), 25.0 + 1e-9) << c;
    }
    EXPECT_LE(fastest, 0.5 * 1.0001) << c;
    EXPECT_LT(late, 1e-4) << c;
  }
}

TEST(ProgressiveFriction, LeavingTheAisleTheForceFadesWithinFiftyMilliseconds) {
  const WallRegion turning = test::aisle(0.0, true), back = test::aisle();
  ProgressiveFriction friction(15.0, Vec2::Zero(), true, 2500.0, Plant{});
  double last = go_round(friction, turning, 4.0 * pi, 0.0, 0.1).norm();
  ASSERT_GT(last, 15.0);
  EffectTick tick;
  for (int i = 1; i <= 50; ++i) {
    const double f = friction.force(test::at(on_circle(0.0), back), tick).norm();
    EXPECT_LT(std::abs(f - last), 0.05 * 18.0) << i;
    last = f;
  }
  EXPECT_EQ(last, 0.0);
}

TEST(ProgressiveFriction, PassingTheCentreCountsNoAngle) {
  const WallRegion region = test::aisle(0.0, true);
  ProgressiveFriction friction(5.0, Vec2::Zero(), true, 2500.0, Plant{});
  EffectTick tick;
  for (int i = -100; i <= 100; ++i) friction.force(test::at({0.0, i * 1e-4}, region), tick);
  EXPECT_NEAR(friction.alpha(), 0.0, 1e-12);
}

TEST(CoulombFriction, HoldsAtRestAndDragsWithItsForceInMotion) {
  const WallRegion region = test::free_region();
  CoulombFriction friction(1.5, 2500.0);
  EffectTick tick;
  EXPECT_EQ(friction.force(test::at({0.08, 0.02}, region), tick).norm(), 0.0);
  Vec2 f = Vec2::Zero();
  for (int i = 0; i < 400; ++i) f = friction.force(test::at({0.08, 0.02 + i * 1e-5}, region), tick);
  EXPECT_NEAR(f.y(), -1.5, 1e-9);
  EXPECT_NEAR(f.x(), 0.0, 1e-9);
}

TEST(CoulombFriction, APushUnderItMovesTheMassALittleAndAPushOverItAway) {
  const WallRegion region = test::free_region();
  for (const double push : {1.4, 1.6}) {
    CoulombFriction friction(1.5, 2500.0);
    Mass mass;
    EffectTick tick;
    double late = 0.0;
    for (int i = 0; i < 20'000; ++i) {
      mass.step(push * std::min(i * kTick, 1.0) +
                friction.force(test::at({mass.x, 0.0}, region), tick).x());
      if (i > 15'000) late = std::max(late, std::abs(mass.v));
    }
    if (push < 1.5) {
      EXPECT_NEAR(mass.x, push / 2500.0, 1e-5);
      EXPECT_LT(late, 1e-6);
    } else {
      EXPECT_NEAR(mass.v, 0.1 / mass.m * 19.0, 0.1);
    }
  }
}

TEST(OneWayAisle, LetsTheHandForwardAndHoldsItBackFromTheFurthestPoint) {
  const WallRegion region = test::aisle(0.0, false, Vec2(0.0, 1.0));
  OneWayAisle aisle(2500.0, Plant{});
  EffectTick tick;
  for (int i = 0; i <= 200; ++i) {
    EXPECT_EQ(aisle.force(test::at({0.01, i * 1e-4}, region), tick).norm(), 0.0);
  }
  Vec2 f = Vec2::Zero();
  for (int i = 0; i < 100; ++i) f = aisle.force(test::at({0.01, 0.018}, region), tick);
  EXPECT_NEAR(f.y(), 2500.0 * 0.002, 1e-9);
  EXPECT_EQ(f.x(), 0.0);
  EXPECT_EQ(aisle.force(test::at({0.01, 0.021}, region), tick).norm(), 0.0);
}

TEST(OneWayAisle, ThePawlSlipsAtTheDevicesMostAndNeverPullsBack) {
  const WallRegion region = test::aisle(0.0, false, Vec2(1.0, 0.0));
  OneWayAisle aisle(2500.0, Plant{});
  EffectTick tick;
  for (int i = 0; i <= 100; ++i) aisle.force(test::at({0.05, 0.0}, region), tick);
  double most = 0.0;
  for (int i = 0; i <= 1000; ++i) {
    const double x = i <= 500 ? 0.05 - i * 1e-4 : (i - 500) * 1e-4;
    const Vec2 f = aisle.force(test::at({x, 0.0}, region), tick);
    EXPECT_GE(f.x(), 0.0);
    // It slipped as far as 25 N / 2.5 N/mm before the hand.
    if (i > 610) {
      EXPECT_EQ(f.x(), 0.0);
    }
    most = std::max(most, f.x());
  }
  EXPECT_NEAR(most, 25.0, 1e-9);
}

TEST(OneWayAisle, ReturningAnotherWayTheTravelCountsAnew) {
  const WallRegion forward = test::aisle(0.0, false, Vec2(1.0, 0.0)), other = test::aisle();
  OneWayAisle aisle(2500.0, Plant{});
  EffectTick tick;
  for (int i = 0; i <= 100; ++i) aisle.force(test::at({i * 1e-4, 0.0}, forward), tick);
  for (int i = 0; i <= 100; ++i) aisle.force(test::at({0.01 - i * 1e-4, 0.01}, other), tick);
  for (int i = 0; i <= 60; ++i) {
    EXPECT_EQ(aisle.force(test::at({0.0, 0.0}, forward), tick).norm(), 0.0);
  }
}

TEST(OneWayAisle, AMassPushedBackComesToRest) {
  const WallRegion region = test::aisle(0.0, false, Vec2(1.0, 0.0));
  OneWayAisle aisle(2500.0, Plant{});
  EffectTick tick;
  Mass mass;
  for (int i = 0; i < 60; ++i) aisle.force(test::at({0.0, 0.0}, region), tick);
  double late = 0.0;
  for (int i = 0; i < 60'000; ++i) {
    mass.step(aisle.force(test::at({mass.x, 0.0}, region), tick).x() - 3.0);
    if (i > 55'000) late = std::max(late, std::abs(mass.v));
  }
  EXPECT_LT(late, 1e-4);
  EXPECT_NEAR(mass.x, -3.0 / 2500.0, 1e-3);
}

}  // namespace
}  // namespace handrail
