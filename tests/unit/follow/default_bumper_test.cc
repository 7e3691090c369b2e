#include <gtest/gtest.h>

#include "server/follow/bumper.h"
#include "tests/unit/constraint/tool_samples.h"

namespace handrail {
namespace {

using test::Dice;
using Phase = BumperState::Phase;

const Vec3 kUp(0.36, -0.48, 0.8);  // out of the surface
const Vec3 kAlong = kUp.unitOrthogonal();
constexpr double kAngle = 1e-9;  // [rad]

double angle(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

// The law with the last place it gave as the place of the arm.
struct Law {
  BumperSettings settings;
  BumperState state;
  BumperInput in;
  Bumped out;

  Law() { in.delay = 0.05; }
  Bumped step(const Vec3& p_SU, const Vec3& f, bool fresh = true) {
    in.p_SU = p_SU;
    in.f_E_S = f;
    in.fresh = fresh;
    in.p_ST = in.p_last;
    out = bump(settings, in, state);
    return out;
  }
  // The arm goes there.
  void go() { in.p_last = out.p_SB; }
  // In contact at the origin, the tip `depth` below it.
  void touch(double depth = 1e-3) {
    in.p_last.setZero();
    step(Vec3::Zero(), Vec3::Zero());
    in.p_last = -depth * kUp;
    for (int i = 0; i < 3; ++i) step(in.p_last, 20.0 * kUp);
    go();
    ASSERT_TRUE(state.touching());
  }
};

TEST(DefaultBumper, NoForceIsNoBumper) {
  Law law;
  Dice dice(61);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 p_SU = dice.within(0.5);
    EXPECT_EQ(law.step(p_SU, dice.between(0.0, 9.99) * dice.unit()).p_SB, p_SU);
    EXPECT_EQ(law.out.why, Reason::kNone);
    law.go();
  }
}

TEST(DefaultBumper, TwoReadingsAboveTheContactForceAreNoContactAndThreeAre) {
  Law law;
  for (const double force : {0.0, 11.0, 11.0, 0.0, 11.0, 11.0}) law.step(kUp, force * kUp);
  EXPECT_EQ(law.state.phase, Phase::kFree);
  law.step(kUp, 11.0 * kUp);
  EXPECT_TRUE(law.state.touching());
}

TEST(DefaultBumper, ASingleReadingAboveTheThresholdIsAContact) {
  Law law;
  law.step(Vec3::Zero(), Vec3::Zero());
  law.step(-1e-2 * kUp, 50.1 * kUp);
  EXPECT_TRUE(law.state.touching());
  EXPECT_GE(law.out.p_SB.dot(kUp), 0.0);
}

TEST(DefaultBumper, APurePushAboveTheThresholdReturnsTheRestPlaceOrBacksOff) {
  for (const double force : {50.1, 100.0, 400.0}) {
    Law law;
    law.touch();
    const Vec3 step = law.step(law.in.p_last - 0.01 * kUp, force * kUp).p_SB - law.in.p_last;
    EXPECT_GE(step.dot(kUp), 0.0) << force;
    EXPECT_LE(step.dot(kUp), 0.25 * law.in.dt + 1e-12) << force;
    EXPECT_LT((step - step.dot(kUp) * kUp).norm(), 1e-12);
    EXPECT_EQ(law.out.why, Reason::kBumper);
  }
}

TEST(DefaultBumper, ASlantingPushSlidesAndDoesNotBackOff) {
  Law law;
  law.settings.friction = 0.0;
  law.touch();
  const Vec3 p_SU = law.in.p_last + 2e-3 * kAlong - 2e-3 * kUp;
  Vec3 step = law.step(p_SU, 47.5 * kUp).p_SB - law.in.p_last;  // the goal: neither in nor out
  EXPECT_NEAR(step.dot(kAlong), 2e-3, 1e-12);
  EXPECT_NEAR(step.dot(kUp), 0.0, 1e-12);
  // Above the threshold it is raised by the cone that is always left for errors, about a degree.
  step = law.step(p_SU, 50.1 * kUp).p_SB - law.in.p_last;
  EXPECT_NEAR(step.dot(kAlong), 2e-3, 1e-12);
  EXPECT_NEAR(step.dot(kUp), std::tan(0.02) * 2e-3, 1e-9);
}

// An arm that turns in contact would come to rest beside where it was told to go: that is not where
// it is to go from now on.
TEST(DefaultBumper, WhereTheArmWouldRestBesideItsCommandLeadsNowhere) {
  Law law;
  law.settings.promise = 200.0;
  law.touch();
  const Vec3 told = law.out.p_SB;
  for (int i = 0; i < 20; ++i) {
    law.in.p_last = law.out.p_SB + 2e-3 * kAlong;
    law.step(told, 20.0 * kUp);
    EXPECT_LT(std::abs((law.out.p_SB - told).dot(kAlong)), 1e-9) << i;
  }
}

TEST(DefaultBumper, RetreatIsNeverSlowed) {
  Dice dice(62);
  for (int i = 0; i < 500; ++i) {
    Law law;
    law.settings.alpha = 0.0;
    law.settings.promise = 200.0;
    law.touch();
    // Straight out under any force, and any way out below the goal.
    const double force = dice.between(5.1, 400.0);
    const double beside = force < 47.0 ? dice.between(-1e-5, 1e-5) : 0.0;
    const double out = force < 47.0 ? dice.between(0.0, 0.1) : dice.between(2e-3, 0.1);
    const Vec3 p_SU = law.in.p_last + beside * kAlong + out * kUp;
    EXPECT_LT((law.step(p_SU, force * kUp).p_SB - p_SU).norm(), 1e-15) << force;
  }
}

TEST(DefaultBumper, ADipBelowTheThresholdDoesNotLetTheStoredCommandIn) {
  Law law;
  law.touch(0.0);
  double inward = 0.0;
  for (int i = 0; i < 100; ++i) {
    const Vec3 last = law.in.p_last;
    law.step(-0.02 * kUp, (i % 2 == 0 ? 51.0 : 44.0) * kUp);
    law.go();
    inward = std::max(inward, (last - law.in.p_last).dot(kUp));
  }
  // A fraction of what 3.5 N more would take, where the published law goes 20 mm.
  EXPECT_GT(inward, 0.0);
  EXPECT_LT(inward, 3.5 / 20e3 * 0.1);
}

// What the noise of 2 N may be, 8 N either way, moves nothing; above the threshold it goes out.
TEST(DefaultBumper, NoiseMovesNothingAtRest) {
  for (const bool held : {true, false}) {
    Law law;
    law.settings.noise = 2.0;
    law.touch(0.0);
    const Vec3 p_SU = law.in.p_last - (held ? 1e-2 : 0.0) * kUp;
    // What is not held yields to 25 N until that is no more than the noise.
    for (int i = 0; i < 1000 && !held; ++i) {
      law.step(p_SU, 25.0 * kUp);
      law.go();
    }
    const double rest = held ? 42.0 : 17.0;
    for (const double off : {7.9, -7.9, 3.0, -3.0}) {
      const Vec3 step = law.step(p_SU, (rest + off) * kUp).p_SB - law.in.p_last;
      EXPECT_NEAR(step.dot(kUp), 0.0, 1e-9) << held << off;
    }
    if (!held) continue;
    EXPECT_LT((law.step(p_SU, 33.0 * kUp).p_SB - law.in.p_last).dot(kUp), -1e-7);
    EXPECT_GT((law.step(p_SU, 51.0 * kUp).p_SB - law.in.p_last).dot(kUp), 1e-7);
  }
}

TEST(DefaultBumper, NoiseOnAWeakForceDoesNotTurnTheNormal) {
  Law law;
  law.settings.noise = 2.0;
  law.touch();
  law.step(law.in.p_last, 17.9 * kAlong);
  EXPECT_LT(angle(law.state.n_S, kUp), kAngle);
  law.step(law.in.p_last, 18.1 * kAlong);
  EXPECT_GT(angle(law.state.n_S, kUp), 0.1);
}

// Felt first far below where it was still free, as fast arms feel it.
TEST(DefaultBumper, AFewNewtonsLessAreNoLeftContactWhereItIsAsDeepAsItWasFelt) {
  Law law;
  law.step(Vec3::Zero(), Vec3::Zero());
  law.in.p_last = -8e-3 * kUp;
  law.step(-10e-3 * kUp, 60.0 * kUp);
  ASSERT_TRUE(law.state.touching());
  law.step(-10e-3 * kUp, 4.9 * kUp);
  EXPECT_TRUE(law.state.touching());
  // Deeper than any force below the threshold explains: it is the surface that went away.
  law.in.p_last -= 8e-3 * kUp;
  law.step(-20e-3 * kUp, 4.9 * kUp);
  EXPECT_EQ(law.state.phase, Phase::kReturning);
}

TEST(DefaultBumper, TheNormalIsNotTiltedByFrictionAndFollowsABentSurface) {
  Law law;
  law.touch();
  const double cone = std::atan(0.3) * 1.05 + 0.02;
  for (const double friction : {0.3, -0.3, 0.0, 0.3}) {
    law.step(law.in.p_last, 30.0 * (kUp + friction * kAlong));
    EXPECT_LT(angle(law.state.n_S, kUp), kAngle);
  }
  const Vec3 bent = (kUp + kAlong).normalized();
  law.step(law.in.p_last, 30.0 * bent);
  EXPECT_NEAR(angle(law.state.n_S, bent), cone, kAngle);
  EXPECT_NEAR(law.state.n_S.dot(kUp.cross(kAlong)), 0.0, 1e-12);
  law.step(law.in.p_last, -30.0 * law.state.n_S);  // the other way round: no direction is nearer
  EXPECT_NEAR(law.state.n_S.norm(), 1.0, 1e-12);
}

TEST(DefaultBumper, ALostReadingIsNoInwardStep) {
  Law law;
  law.touch();
  const Vec3 deeper = law.in.p_last - 5e-3 * kUp;
  EXPECT_LT((law.step(deeper, 20.0 * kUp).p_SB - law.in.p_last).dot(kUp), -1e-6);
  const Vec3 step = law.step(deeper + 1e-3 * kAlong, 20.0 * kUp, false).p_SB - law.in.p_last;
  EXPECT_GE(step.dot(kUp), -1e-15);
  EXPECT_NEAR(step.dot(kAlong), 1e-3, 1e-12);
}

TEST(DefaultBumper, ALeftContactIsForgottenByPlaceNotByCommand) {
  Law law;
  law.touch();
  law.in.p_last = 2e-3 * kUp;  // clear of the surface, the command half a millimetre nearer
  law.step(1.5e-3 * kUp, Vec3::Zero());
  EXPECT_EQ(law.state.phase, Phase::kReturning);
  for (int i = 0; i < 20; ++i) {
    law.step(1.5e-3 * kUp, Vec3::Zero());
    law.go();
  }
  EXPECT_EQ(law.state.phase, Phase::kFree);
  EXPECT_EQ(law.out.p_SB, 1.5e-3 * kUp);
  // Over the surface, but the command deep in it: still a contact.
  law.touch();
  law.in.p_last = 0.5e-3 * kUp;
  law.step(-5e-3 * kUp, Vec3::Zero());
  EXPECT_TRUE(law.state.touching());
}

TEST(DefaultBumper, WhatWasHeldBackIsNotLetGoWhereTheForceTurnsAside) {
  Law law;
  law.touch();
  for (int i = 0; i < 20; ++i) {
    law.step(-12e-3 * kUp, 48.0 * kUp);
    law.go();
  }
  const Vec3 held = law.in.p_last;
  // The tip slips off an edge and leans against a wall beside it.
  for (int i = 0; i < 28; ++i) {
    law.step(-12e-3 * kUp, 20.0 * kAlong);
    law.go();
  }
  EXPECT_LT((held - law.in.p_last).dot(kUp), 0.01 * 0.2) << "10 mm/s at most";
  // And into the open: no faster.
  for (int i = 0; i < 28; ++i) {
    law.step(-12e-3 * kUp, Vec3::Zero());
    law.go();
  }
  EXPECT_LT((held - law.in.p_last).dot(kUp), 0.01 * 0.4 + 1e-3);
}

TEST(DefaultBumper, AnArmThatOvershootsIsNotLedEverFurtherOut) {
  Law law;
  law.touch();
  const Vec3 began = law.in.p_last;
  for (int i = 0; i < 100; ++i) {
    law.step(began - 0.05 * kUp, 5.0 * kUp);
    law.in.p_last = law.out.p_SB + 2e-3 * kUp;
  }
  EXPECT_TRUE(law.state.touching());
  EXPECT_LT((law.in.p_last - began).dot(kUp), 2e-3 + 1e-9);
}

TEST(DefaultBumper, AnArmThatGoesFurtherInThanToldIsToldTheSameAgain) {
  Law law;
  law.touch();
  const Vec3 began = law.in.p_last;
  for (int i = 0; i < 100; ++i) {
    law.step(began - 0.05 * kUp, 60.0 * kUp);
    ASSERT_GE((law.out.p_SB - began).dot(kUp), 0.0) << i;
    law.in.p_last = law.out.p_SB - 2e-3 * kUp;
  }
}

TEST(DefaultBumper, AnApproachIsNotLedOnByAnArmThatOvershoots) {
  Law law;
  law.settings.promise = 200.0;
  const double v = approach_speed(law.settings, 150.0, law.in.delay, law.in.dt);
  law.step(Vec3::Zero(), Vec3::Zero());
  for (int i = 0; i < 100; ++i) {
    law.step(-0.5 * kUp, Vec3::Zero());
    law.in.p_last = law.out.p_SB - 2e-3 * kUp;
  }
  EXPECT_NEAR(-law.out.p_SB.dot(kUp), 100 * v * law.in.dt, 1e-9);
}

// A hand that slides faster than the promise lets the arm is no reason to leave the surface.
TEST(DefaultBumper, AboveTheThresholdItIsRaisedByTheWayItGoesNotByTheWayAsked) {
  Law law;
  law.settings.promise = 200.0;
  law.touch();
  const double most = approach_speed(law.settings, 150.0, law.in.delay, law.in.dt) * law.in.dt;
  const Vec3 step = law.step(law.in.p_last + 0.04 * kAlong, 50.1 * kUp).p_SB - law.in.p_last;
  EXPECT_NEAR(step.dot(kAlong), most, 1e-9);
  EXPECT_NEAR(step.dot(kUp), std::tan(std::atan(0.3) * 1.05 + 0.02) * most, 1e-5);
}

TEST(DefaultBumper, TheApproachIsAsSlowAsThePromisedForceAsks) {
  Law law;
  law.settings.promise = 200.0;
  const double v = approach_speed(law.settings, 150.0, law.in.delay, law.in.dt);
  // k (v late + v^2 / 2a) is the force that is left for it.
  const double late = law.in.delay + 2.5 * law.in.dt + 0.01;
  EXPECT_NEAR(60e3 * (v * late + v * v / 12.0), 150.0, 1e-9);
  law.step(0.1 * kAlong, Vec3::Zero());
  EXPECT_NEAR(law.out.p_SB.norm(), v * law.in.dt, 1e-15);
  EXPECT_EQ(law.out.why, Reason::kApproach);
  law.step(0.9 * v * law.in.dt * kAlong, Vec3::Zero());
  EXPECT_EQ(law.out.p_SB, 0.9 * v * law.in.dt * kAlong);
  EXPECT_EQ(law.out.why, Reason::kNone);
}

}  // namespace
}  // namespace handrail
