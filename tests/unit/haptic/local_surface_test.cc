// The touched surface at the hand.
#include "server/haptic/local_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/unit/haptic/haptic_rig.h"

namespace handrail {
namespace {

using test::HapticRig;

constexpr double kDt = 1e-3;
constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

// A floor at 0, told and felt, the hand 4 mm in it; mapping 2.
struct Felt {
  LocalSurface surface;
  LocalSurfaceInput in;
  LocalSurfaceForce out;

  Felt() {
    in.told = Surface{Vec3::UnitZ(), 0.0, 60e3};
    in.p_SU = {0, 0, -4e-3};
    in.p_ST = {0, 0, -1e-3};
    in.f_E_S = {0, 0, 45.0};
    in.has_force = true;
    in.scale = 2.0;
    in.most_stiffness = 800.0;
  }
  void ticks(int n) {
    for (int i = 0; i < n; ++i) out = surface.step(in, kDt);
  }
};

TEST(LocalSurface, PushesByTheDeepnessAtTheHandAsHardAsTheDeviceHolds) {
  Felt it;
  it.ticks(101);
  EXPECT_NEAR(it.out.push, 800.0 * 2e-3, 1e-9);
  EXPECT_NEAR(it.out.stiffness, 800.0, 1e-9);
  EXPECT_EQ(it.out.n_S, Vec3::UnitZ());
  EXPECT_NEAR(it.out.share, 1.0, 1e-9);
}

TEST(LocalSurface, ASoftOneIsAsSoftAsTheHandsMotionMakesIt) {
  Felt it;
  it.in.told->stiffness = 150.0;
  it.ticks(200);
  EXPECT_NEAR(it.out.push, 4.0 * 150.0 * 2e-3, 1e-9);
}

TEST(LocalSurface, OutOfItNothingPushesAndFarOutTheSpringIsWhole) {
  Felt it;
  it.in.p_SU.z() = 1e-3;
  it.ticks(200);
  EXPECT_EQ(it.out.push, 0.0);
  EXPECT_NEAR(it.out.share, 0.9, 1e-9);
  it.in.p_SU.z() = 0.02;
  it.ticks(1);
  EXPECT_EQ(it.out.share, 0.0);
}

TEST(LocalSurface, ComesAndGoesInItsTimeWithoutAStep) {
  Felt it;
  const double most_step = 800.0 * kDt / LocalSurface::kFade * 2e-3;
  double last = 0.0;
  for (int i = 0; i < 300; ++i) {
    if (i == 150) it.in.told.reset();
    it.ticks(1);
    EXPECT_LE(std::abs(it.out.push - last), most_step + 1e-12) << i;
    last = it.out.push;
  }
  EXPECT_FALSE(it.surface.known());
  EXPECT_EQ(it.out.push, 0.0);
  EXPECT_EQ(it.out.why, Reason::kNone);
}

TEST(LocalSurface, ThePlaneMovesAtItsRateToWhereItIsTold) {
  Felt it;
  it.ticks(200);
  it.in.told->d = 5e-3;
  for (int i = 1; i <= 100; ++i) {
    it.ticks(1);
    EXPECT_NEAR(it.surface.model().d, i * LocalSurface::kPlaneRate * kDt, 1e-9);
  }
  it.ticks(200);
  EXPECT_NEAR(it.surface.model().d, 5e-3, 1e-12);
}

TEST(LocalSurface, TheNormalTurnsAtItsRateAboutWhereTheHandIs) {
  Felt it;
  it.in.p_SU = {0.5, 0.1, -4e-3};
  it.ticks(200);
  const Vec3 n = Vec3(0.3, 0, 1).normalized();
  it.in.told = Surface{n, n.dot(Vec3(0.5, 0.1, 0.0)), 60e3};
  for (int i = 1; i <= 100; ++i) {
    const Vec3 before = it.surface.model().n_S;
    const double deep = it.surface.model().out_of(it.in.p_SU);
    it.ticks(1);
    EXPECT_NEAR(std::acos(std::min(1.0, before.dot(it.surface.model().n_S))),
                LocalSurface::kNormalRate * kDt, 1e-8);
    EXPECT_NEAR(it.surface.model().out_of(it.in.p_SU), deep,
                LocalSurface::kPlaneRate * kDt + 1e-12);
  }
  it.ticks(1000);
  EXPECT_LT((it.surface.model().n_S - n).norm(), 1e-12);
}

TEST(LocalSurface, WhatCannotBeFadesAndSaysSo) {
  const Surface sound{Vec3::UnitZ(), 0.0, 60e3};
  for (const Surface& told :
       {Surface{-Vec3::UnitZ(), 0.0, 60e3}, Surface{Vec3::UnitX(), 0.0, 60e3},
        Surface{Vec3::UnitZ(), 0.021, 60e3}, Surface{Vec3::UnitZ(), kNoNumber, 60e3},
        Surface{Vec3::UnitZ(), 0.0, kNoNumber}, Surface{{0, 0, kNoNumber}, 0.0, 60e3},
        Surface{{0, 0, 2}, 0.0, 60e3}, Surface{Vec3::UnitZ(), 0.0, -1.0}}) {
    Felt it;
    it.ticks(150);
    const double before = it.out.push;
    it.in.told = told;
    it.ticks(1);
    EXPECT_EQ(it.out.why, Reason::kSurfaceElsewhere);
    EXPECT_GT(it.out.push, 0.98 * before);
    EXPECT_LT(it.out.push, before);
    it.ticks(100);
    EXPECT_TRUE(std::isfinite(it.out.push));
    EXPECT_TRUE(is_finite(it.out.n_S));
    it.in.told = sound;
    it.ticks(300);
    EXPECT_NEAR(it.out.push, before, 1e-9);
    EXPECT_EQ(it.out.why, Reason::kNone);
  }
}

TEST(LocalSurface, WhatIsNotFeltBehindItFadesAndStaysAwayUntilAnotherIsTold) {
  Felt it;
  it.ticks(200);
  it.in.p_ST.z() = -3e-3;
  it.in.f_E_S.setZero();
  it.ticks(1950);
  EXPECT_GT(it.out.push, 1.0);
  it.ticks(200);
  EXPECT_FALSE(it.surface.known());
  it.ticks(500);
  EXPECT_EQ(it.out.push, 0.0);
  it.in.told->d = 1e-4;
  it.in.f_E_S.z() = 45.0;
  it.ticks(200);
  EXPECT_GT(it.out.push, 1.0);
}

TEST(LocalSurface, WhatIsFeltNowAndThenStays) {
  Felt it;
  it.in.p_ST.z() = -3e-3;
  for (int i = 0; i < 5; ++i) {
    it.in.f_E_S.z() = 0.0;
    it.ticks(1500);
    it.in.f_E_S.z() = 20.0;
    it.ticks(1);
  }
  EXPECT_EQ(it.out.why, Reason::kNone);
  EXPECT_GT(it.out.push, 1.0);
}

TEST(LocalSurface, ASoftOneIsFeltWhereItPushesLittle) {
  Felt it;
  it.in.told->stiffness = 300.0;
  it.in.p_ST.z() = -3e-3;
  it.in.f_E_S.z() = 0.9;
  it.ticks(5000);
  EXPECT_TRUE(it.surface.known());
  it.in.f_E_S.z() = 0.2;
  it.ticks(2200);
  EXPECT_FALSE(it.surface.known());
}

// The hand is `deep` in what it asks for, the tip stands at the surface.
struct AtTheHand : HapticRig {
  AtTheHand() {
    settings.surface_stiffness = 800.0;
    settings.guide.smoother_length = 200;
    engage();
    spring_slack = false;
    at = command().p;
    in.slave.surface = Surface{Vec3::UnitZ(), at.z(), 60e3};
    in.slave.f_E_S.force = {0, 0, 45.0};
    in.slave.has_wrench = true;
    in.slave.X_ST.p = at;
  }
  // Device Y is the base's Z.
  void press(double deep, int n) {
    const double step = deep / settings.mapping.scale / n;
    for (int i = 0; i < n; ++i) {
      in.hand.X_MH.p.y() -= step;
      tick();
    }
  }
  Vec3 at;
};

TEST(LocalSurface, TheHandFeelsItInPlaceOfTheSpringAlongIt) {
  AtTheHand rig;
  rig.press(4e-3, 400);
  rig.ticks(300);
  EXPECT_NEAR(rig.out.f_H_M.force.y(), 800.0 * 2e-3, 1e-6);
  EXPECT_NEAR(rig.out.force.walls.y(), 800.0 * 2e-3, 1e-6);
  EXPECT_LT(rig.out.force.spring.norm(), 1e-9);
  // Sideways the spring is what it was.
  rig.in.slave.X_ST.p.y() += 2e-3;
  rig.ticks(300);
  EXPECT_NEAR(std::hypot(rig.out.f_H_M.force.x(), rig.out.f_H_M.force.z()), 200.0 * 1e-3, 1e-6);
  EXPECT_NEAR(rig.out.f_H_M.force.y(), 800.0 * 2e-3, 1e-6);
}

// A line at 60 degrees to it bears what is across it. At the hand Y is the base's Z, and -Z its X.
TEST(LocalSurface, OfASlantedToolTheHandFeelsWhatIsAlongIt) {
  AtTheHand rig;
  const Vec3 along_S(0.5, 0.0, std::sqrt(0.75)), along_M(0.0, along_S.z(), -along_S.x());
  rig.call(test::line_call(along_S));
  rig.ticks(300);
  const Vec3 hand = rig.in.hand.X_MH.p;
  for (int i = 1; i <= 100; ++i) {
    rig.in.hand.X_MH.p = hand - 2e-5 * i * along_M;
    rig.tick();
  }
  rig.ticks(400);
  // 2 mm down the line are 1.73 mm into it.
  const double push = 800.0 * 2e-3 * along_S.z();
  EXPECT_LT((rig.out.force.walls - push * along_S.z() * along_M).norm(), 1e-6);
  EXPECT_LT(rig.out.force.tool.norm(), 1e-6);
  // And of the spring a quarter of what is along it, wherever the tip is held beside it.
  for (const double beside : {0.0, 1e-3}) {
    rig.in.slave.X_ST.p.y() += beside;
    rig.ticks(400);
    EXPECT_LT((rig.out.force.spring - 0.25 * 200.0 * 2e-3 * along_M).norm(), 1e-6) << beside;
  }
  // A point holds the tip whatever pushes it.
  rig.call(test::call_of(ToolKind::kPoint));
  rig.ticks(400);
  EXPECT_EQ(rig.out.force.walls.norm(), 0.0);
}

// Else a hand that goes around gains more each time: 800 N/m of it on 2 mm by 2 mm were 1.9 mJ.
TEST(LocalSurface, AWayAroundBesideASlantedToolMakesNothing) {
  AtTheHand rig;
  rig.settings.guide.smoother_length = 1;
  rig.spring_slack = true;
  const Vec3 along_S(0.5, 0.0, std::sqrt(0.75)), along_M(0.0, along_S.z(), -along_S.x());
  const Vec3 across_M(0.0, 0.5, along_S.z());
  rig.call(test::line_call(along_S));
  rig.ticks(300);
  const Vec3 hand = rig.in.hand.X_MH.p;
  double work = 0.0, largest = 0.0;
  // Either way around, as what is made one way is lost the other.
  for (const double way : {1.0, -1.0}) {
    double round = 0.0;
    for (int i = 1; i <= 4000; ++i) {
      const double angle = way * i * std::numbers::pi / 2000.0;
      const Vec3 to = hand - 1e-3 * ((2.0 - 2.0 * std::cos(angle)) * along_M -
                                     2.0 * std::sin(angle) * across_M);
      const Vec3 by = to - rig.in.hand.X_MH.p, before = rig.out.f_H_M.force;
      rig.in.hand.X_MH.p = to;
      rig.tick();
      round += 0.5 * (before + rig.out.f_H_M.force).dot(by);
      largest = std::max(largest, rig.out.force.walls.norm());
    }
    work = std::max(work, round);
  }
  EXPECT_GT(largest, 1.0);
  EXPECT_LT(work, 1e-5);
}

TEST(LocalSurface, ItIsFeltWithoutTheSmoothersLag) {
  AtTheHand rig;
  rig.ticks(200);
  rig.press(4e-3, 20);
  EXPECT_NEAR(rig.out.force.walls.y(), 800.0 * 2e-3, 1e-6);
}

TEST(LocalSurface, WithoutTheSettingTheSpringAloneIsFelt) {
  AtTheHand rig;
  rig.settings.surface_stiffness = 0.0;
  rig.press(4e-3, 400);
  rig.ticks(300);
  EXPECT_NEAR(rig.out.f_H_M.force.y(), 200.0 * 2e-3, 1e-6);
  EXPECT_EQ(rig.out.force.walls.norm(), 0.0);
}

TEST(LocalSurface, ItIsAsStiffAsItMayBe) {
  AtTheHand rig;
  rig.settings.surface_stiffness = 300.0;
  rig.press(4e-3, 400);
  rig.ticks(300);
  EXPECT_NEAR(rig.out.f_H_M.force.y(), 300.0 * 2e-3, 1e-6);
}

TEST(LocalSurface, TheReasonIsInTheStatus) {
  AtTheHand rig;
  rig.press(4e-3, 400);
  rig.in.slave.surface->n_S = -Vec3::UnitZ();
  rig.ticks(2);
  EXPECT_TRUE(rig.out.reasons.has(Reason::kSurfaceElsewhere));
}

TEST(LocalSurface, TheClutchForgetsIt) {
  AtTheHand rig;
  rig.press(4e-3, 400);
  ASSERT_TRUE(rig.state->force.surface.known());
  rig.order(OrderKind::kClutchOn);
  rig.ticks(3);
  EXPECT_FALSE(rig.state->force.surface.known());
}

// The arm stands, and so does what it touches: a hand that goes on is pushed as before.
TEST(LocalSurface, WhileTheArmHoldsItPushesAndTheSpringDoesNot) {
  AtTheHand rig;
  rig.press(4e-3, 400);
  rig.in.slave.X_ST.p.y() += 2e-3;
  rig.ticks(300);
  for (int ms = 1; ms <= 150; ++ms) {
    rig.in.slave_age = ms * kMillisecond;
    rig.in.hand.X_MH.p.y() -= 5e-6;
    rig.tick();
    const Vec3 force = rig.out.f_H_M.force - rig.out.force.cue;
    // What is too much for a tick is taken from the whole step.
    ASSERT_NEAR(force.y(), 800.0 * (2e-3 + ms * 5e-6), ms <= 50 ? 4e-3 : 1e-6) << ms;
    ASSERT_LE(rig.force_step, rig.settings.force.peak / 25.0 + 4e-3 + 0.1) << ms;
    if (ms <= 50) continue;
    ASSERT_NEAR(std::hypot(force.x(), force.z()), 0.0, 1e-9) << ms;
  }
  ASSERT_EQ(rig.session(), SessionState::kHold);
  EXPECT_TRUE(rig.out.reasons.has(Reason::kForceFaded));
}

TEST(LocalSurface, ALostLinkTakesItWithTheEngagement) {
  AtTheHand rig;
  rig.press(4e-3, 400);
  rig.in.slave_age = 100 * kMillisecond;
  rig.ticks(50);
  rig.in.slave_age = 201 * kMillisecond;
  rig.ticks(26);
  ASSERT_EQ(rig.session(), SessionState::kFault);
  EXPECT_EQ((rig.out.f_H_M.force - rig.out.force.cue).norm(), 0.0);
}

TEST(LocalSurface, ItsEnergyIsGovernedWithTheTools) {
  AtTheHand rig;
  rig.settings.governor.on = true;
  rig.press(4e-3, 400);
  rig.ticks(100);
  double made = 0.0;
  for (int i = 0; i < 2000; ++i) {  // in and out of it, 1 mm at 10 Hz: each tick makes K dx^2 / 2
    rig.in.hand.X_MH.p.y() += 1e-3 * 0.0628 * std::cos(0.0628 * i);
    rig.tick();
    made = std::max(made, rig.out.energy_made);
  }
  EXPECT_GT(made, 0.0);
  EXPECT_TRUE(rig.finite);
}

}  // namespace
}  // namespace handrail
