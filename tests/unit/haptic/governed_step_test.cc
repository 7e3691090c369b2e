// The governor in the two steps: what reaches the device, and what is said of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "server/haptic/wall_step.h"
#include "tests/unit/haptic/haptic_rig.h"
#include "tests/unit/haptic/wall_rig.h"

namespace handrail {
namespace {

using test::HapticRig;
using test::WallRig;

GovernorSettings governed(double friction, double peak) {
  GovernorSettings out;
  out.on = true;
  out.friction = friction;
  out.peak = peak;
  return out;
}

// Energy that the hand gets while it goes to 4 mm into the wall and out again, at 0.5 m/s [J].
double through_the_wall(WallRig& rig) {
  double given = 0.0;
  Vec2 last(-4e-3, 0.0), force = rig.move(last);
  for (int i = 0; i <= 32; ++i) {
    const Vec2 p(-4e-3 + (i <= 16 ? 5e-4 * i : 5e-4 * (32 - i)), 0.0);
    given += force.dot(p - last);
    last = p;
    force = rig.move(p);
  }
  return given;
}

TEST(GovernedStep, AWallGivesTheHandNoMoreThanItGave) {
  WallRig held;
  const double made = through_the_wall(held);
  EXPECT_GT(made, 5e-3);  // K v T / 2 on 8 mm
  WallRig rig;
  rig.settings.governor = governed(0.0, 25.3);
  EXPECT_LT(through_the_wall(rig), 0.1 * made);
  // With friction that takes as much up it does not act.
  WallRig dry;
  dry.settings.governor = governed(1.3, 25.3);
  EXPECT_EQ(through_the_wall(dry), made);
}

// The stylus is turned by 0.2 rad and back, at 10 rad/s, against a tool that holds it.
double through_a_turn(HapticRig& rig) {
  rig.settings.has_torque = true;
  rig.settings.max_torque = 1.0;
  rig.engage();
  rig.call(test::call_of(ToolKind::kNRotation));
  const Quat began = rig.in.hand.X_MH.q;
  double given = 0.0;
  for (int i = 1; i <= 40; ++i) {
    given += rig.out.f_H_M.torque.y() * (i <= 20 ? 0.01 : -0.01);
    rig.in.hand.X_MH.q = rotation_exp({0.0, 0.01 * (i <= 20 ? i : 40 - i), 0.0}) * began;
    rig.tick();
  }
  return given;
}

TEST(GovernedStep, AnOrientationToolGivesTheHandNoMoreThanItGave) {
  HapticRig held;
  const double made = through_a_turn(held);
  EXPECT_NEAR(made, 1e-3, 1e-5);  // K w T / 2 on 0.4 rad
  HapticRig rig;
  rig.settings.turn_governor = governed(0.0, 1.0);
  EXPECT_LT(through_a_turn(rig), 0.1 * made);
  EXPECT_LE(rig.out.energy_made, 0.1 * made);
  HapticRig dry;
  dry.settings.turn_governor = governed(0.01, 1.0);
  EXPECT_EQ(through_a_turn(dry), made) << "friction takes 0.01 N m on the same way";
}

TEST(GovernedStep, WhatItTakesOfATorqueHasItsReason) {
  HapticRig rig;
  rig.settings.turn_governor = governed(0.0, 1.0);
  bool said = false;
  double most = 0.0;
  rig.settings.has_torque = true;
  rig.settings.max_torque = 1.0;
  rig.engage();
  rig.call(test::call_of(ToolKind::kNRotation));
  const Quat began = rig.in.hand.X_MH.q;
  for (int i = 1; i <= 40; ++i) {
    rig.in.hand.X_MH.q = rotation_exp({0.0, 0.01 * (i <= 20 ? i : 40 - i), 0.0}) * began;
    rig.tick();
    ASSERT_FALSE(i <= 20 && rig.out.reasons.has(Reason::kForceEnergy)) << i;
    most = std::max(most, rig.out.energy_made);
    said = said || rig.out.reasons.has(Reason::kForceEnergy);
  }
  EXPECT_TRUE(said);
  // On each of twenty ticks out a held torque takes K turn^2 / 2 too little, and so it gives too
  // much where the stylus turns back, which no one knows beforehand.
  EXPECT_NEAR(most, 21.0 * 0.5 * 0.01 * 0.01 / 2.0, 1e-7);
}

// Turned back by less than a jump while it was not heard: no torque did work on it.
TEST(GovernedStep, AHandThatIsNotHeardGetsNoTorqueAndOwesNoEnergy) {
  HapticRig rig;
  rig.settings.turn_governor = governed(0.0, 1.0);
  rig.settings.turn_governor.delay = 5;
  rig.settings.has_torque = true;
  rig.settings.max_torque = 1.0;
  rig.engage();
  rig.call(test::call_of(ToolKind::kNRotation));
  const Quat began = rig.in.hand.X_MH.q;
  for (int i = 1; i <= 20; ++i) {
    rig.in.hand.X_MH.q = rotation_exp({0.0, 0.01 * i, 0.0}) * began;
    rig.tick();
  }
  ASSERT_GT(rig.out.f_H_M.torque.norm(), 0.09);
  const double owed = rig.out.energy_made;
  rig.in.hand.valid = false;
  rig.tick();
  EXPECT_EQ(rig.out.f_H_M.torque.norm(), 0.0);
  rig.in.hand.valid = true;
  rig.in.hand.X_MH.q = rotation_exp({0.0, 0.16, 0.0}) * began;
  rig.tick();
  EXPECT_LE(rig.out.energy_made, owed);
}

TEST(GovernedStep, WhatItTakesIsInTheLedgerAndHasItsReason) {
  WallRig rig;
  rig.settings.governor = governed(0.0, 25.3);
  bool said = false;
  rig.move({-4e-3, 0.0});
  for (int i = 0; i <= 32; ++i) {
    rig.move({-4e-3 + (i <= 16 ? 5e-4 * i : 5e-4 * (32 - i)), 0.0});
    const ForceLedger& f = rig.out.ledger;
    ASSERT_LT((f.walls + f.governor + f.limits + f.clamp - f.device).norm(), 1e-12);
    ASSERT_EQ(rig.out.reasons.has(Reason::kForceEnergy), f.governor.norm() > 0.0) << i;
    said = said || rig.out.reasons.has(Reason::kForceEnergy);
    if (i <= 16) {
      ASSERT_EQ(f.governor.norm(), 0.0) << "on the way in";
    }
  }
  EXPECT_TRUE(said);
}

// What is said of it goes to where the work is reckoned: on the way out the force before was
// larger.
TEST(GovernedStep, AForceThatMissedItsTurnCountsAsTheOneBefore) {
  double wall[2] = {}, tool[2] = {};
  for (const int missed : {0, 1}) {
    WallRig rig;
    rig.settings.governor = governed(0.0, 25.3);
    rig.in.hand.force_missed = missed == 1;
    (void)through_the_wall(rig);
    wall[missed] = rig.out.energy_made;
    HapticRig arm;
    arm.engage();
    arm.settings.governor = governed(0.0, 3.3);
    ToolCall line;
    line.kind = ToolKind::kLine;
    line.direction_S = Vec3::UnitX();
    ASSERT_EQ(arm.call(line), Reason::kNone);
    arm.in.hand.force_missed = missed == 1;
    for (int i = 0; i < 200; ++i) {
      arm.in.hand.X_MH.p.y() += i < 100 ? 2e-5 : -2e-5;
      arm.tick();
      tool[missed] = std::max(tool[missed], arm.out.energy_made);
    }
  }
  EXPECT_GT(wall[1], 1.5 * wall[0]);
  EXPECT_GT(tool[1], 1.5 * tool[0]);
}

TEST(GovernedStep, OnlyItsShareIsRendered) {
  WallRig rig;
  rig.settings.share = 0.25;
  rig.move({-1e-3, 0.0});
  for (int i = 0; i <= 20; ++i) rig.move({1e-4 * i, 0.0});
  EXPECT_NEAR(rig.move({2e-3, 0.0}).x(), -0.25 * 5000.0 * 2e-3, 1e-9);
}

TEST(GovernedStep, AStageThatComesIsNotTheHandsWork) {
  WallRig rig;
  rig.settings.governor = governed(0.0, 25.3);
  rig.walls->stages[1].gone = {1};
  rig.in.stage = 1;
  rig.move({2e-3, 0.0});
  rig.in.stage = 0;
  for (int i = 0; i < 200; ++i) rig.move({2e-3, 0.0});
  EXPECT_EQ(rig.out.energy_made, 0.0);
  EXPECT_NEAR(rig.out.f_H_M.force.x(), -10.0, 1e-9);
}

TEST(GovernedStep, AToolIsNoStifferThanTheDeviceHolds) {
  HapticRig rig;
  rig.settings.guide.most_stiffness = 300.0;
  rig.engage();
  ToolCall line;
  line.kind = ToolKind::kLine;
  line.direction_S = Vec3::UnitX();
  line.stiffness = 5000.0;
  ASSERT_EQ(rig.call(line), Reason::kNone);
  for (int i = 0; i < 500; ++i) {
    rig.in.hand.X_MH.p.y() += 1e-5;
    rig.tick();
  }
  EXPECT_NEAR(rig.out.shares.tool.norm(), 300.0 * 5e-3, 0.02 * 1.5);
  EXPECT_EQ(rig.out.link.position_tool.stiffness, 5000.0) << "what both sides hash stays";
}

TEST(GovernedStep, AStandingTipGivesBackWhatWasPutIntoTheSpring) {
  HapticRig rig;
  rig.settings.guide.smoother_length = 1;
  rig.engage();
  rig.settings.governor = governed(0.0, 3.3);
  rig.play_slave = false;
  double put = 0.0, back = 0.0;
  for (int i = 0; i < 400; ++i) {
    const Vec3 before = rig.in.hand.X_MH.p;
    rig.in.hand.X_MH.p.x() += i < 200 ? 2e-5 : -2e-5;
    const double work = rig.out.f_H_M.force.dot(rig.in.hand.X_MH.p - before);
    (work < 0.0 ? put : back) += std::abs(work);
    rig.in.slave_age = 0;
    rig.tick();
  }
  EXPECT_GT(put, 0.5e-3);
  EXPECT_GT(back, 0.9 * put);
  EXPECT_LE(back, put);
}

// A floor that the slave tells of, where the tip stands; the smoother adds nothing.
struct OnAFloor : HapticRig {
  explicit OnAFloor(bool governor, double stiffness = 60e3) {
    settings.surface_stiffness = 800.0;
    settings.guide.smoother_length = 1;
    engage();
    settings.governor = governed(0.0, 3.3);
    settings.governor.on = governor;
    play_slave = false;
    in.slave.surface = Surface{Vec3::UnitZ(), command().p.z(), stiffness};
    in.slave.f_E_S.force = {0, 0, 45.0};
    in.slave.has_wrench = true;
    ticks(200);
  }
  // 2 mm into it and out again, `step` a tick [m]. Device Y is the base's Z. What the hand put into
  // it and got back [J].
  struct Work {
    double put = 0.0, back = 0.0;
  };
  Work there_and_back(double step) {
    Work work;
    const int n = static_cast<int>(std::lround(2e-3 / step));
    for (int i = 0; i < 2 * n; ++i) {
      const double way = i < n ? -step : step;
      const double done = way * out.f_H_M.force.y();
      (done < 0.0 ? work.put : work.back) += std::abs(done);
      in.hand.X_MH.p.y() += way;
      tick();
    }
    return work;
  }
};

// A millisecond's hold makes K v T / 2 on the whole way, here 0.5 % of what is put in.
TEST(GovernedStep, ATouchedSurfaceGivesBackWhatWasPutIntoIt) {
  OnAFloor rig(true);
  for (int i = 0; i < 3; ++i) {
    const OnAFloor::Work slow = rig.there_and_back(1e-5);
    EXPECT_GT(slow.put, 1.5e-3);
    EXPECT_GT(slow.back, 0.98 * slow.put) << i;
    EXPECT_LT(slow.back, 1.001 * slow.put) << i;
  }
}

TEST(GovernedStep, ATouchedSurfaceGivesTheHandNoMoreThanItGave) {
  OnAFloor held(false), rig(true);
  const OnAFloor::Work made = held.there_and_back(2e-4);
  EXPECT_GT(made.back, 1.15 * made.put);
  const OnAFloor::Work work = rig.there_and_back(2e-4);
  EXPECT_LT(work.back, 1.02 * work.put);
}

// 0.1 N/mm at the tip is 0.4 at the hand; the tools', of which none is called, are 0.8.
TEST(GovernedStep, ASoftSurfaceIsGovernedAsTheSpringItIs) {
  OnAFloor rig(true, 100.0);
  const OnAFloor::Work work = rig.there_and_back(2e-4);
  EXPECT_GT(work.put, 0.6e-3);
  EXPECT_GT(work.back, 0.98 * work.put);
  EXPECT_LT(work.back, 1.02 * work.put);
}

// What the spring may give is gone within a millimetre; the limit of the force's steps lets it go
// more slowly. What that gives is taken back, or each turn would give it anew.
TEST(GovernedStep, AForceThatMayNotEndAtOnceIsPaidForLater) {
  HapticRig rig;
  rig.settings.guide.smoother_length = 1;
  rig.engage();
  rig.settings.governor = governed(0.0, 3.3);
  rig.play_slave = false;
  const Vec3 home = rig.in.slave.X_ST.p;
  double given = 0.0;
  const auto move = [&](int ticks, double step, double pull) {
    for (int i = 0; i < ticks; ++i) {
      rig.in.slave.X_ST.p = home + rig.settings.mapping.R_SM * Vec3(pull, 0, 0);
      given += rig.out.f_H_M.force.x() * step;
      rig.in.hand.X_MH.p.x() += step;
      rig.tick();
    }
  };
  constexpr double kStep = 1e-4, kPull = 20e-3;  // [m]
  double most = 0.0;
  for (int turn = 0; turn < 30; ++turn) {
    move(100, 0.0, kPull);
    move(2, -kStep, kPull);
    move(40, kStep, kPull);
    move(100, 0.0, 0.0);
    move(30, -kStep, 0.0);
    most = std::max(most, given);
  }
  EXPECT_GT(most, 0.0);
  EXPECT_LT(given, 1e-3);
}

// A tip that swings by itself pulls a hand to and fro that goes with it.
TEST(GovernedStep, ATipThatMovesByItselfGivesTheHandNothing) {
  for (const bool on : {false, true}) {
    HapticRig rig;
    rig.play_slave = true;
    rig.engage();
    if (on) rig.settings.governor = governed(0.0, 3.3);
    rig.play_slave = false;
    const Vec3 home = rig.in.slave.X_ST.p, start = rig.in.hand.X_MH.p;
    double given = 0.0;
    for (int i = 1; i <= 4000; ++i) {
      const double swing = std::sin(2.0 * 3.14159265 * 2.0 * 1e-3 * i);
      rig.in.slave.X_ST.p = home + rig.settings.mapping.R_SM * Vec3(0.01 * swing, 0, 0);
      const Vec3 before = rig.in.hand.X_MH.p;
      // A quarter behind the tip's pull: the worst for the energy.
      rig.in.hand.X_MH.p = start + Vec3(-2e-3 * std::cos(2.0 * 3.14159265 * 2.0 * 1e-3 * i), 0, 0);
      given += rig.out.f_H_M.force.dot(rig.in.hand.X_MH.p - before);
      rig.in.slave_age = 0;
      rig.tick();
    }
    if (on) {
      EXPECT_LT(given, 1e-4);
    } else {
      EXPECT_GT(given, 5e-3);
    }
  }
}

}  // namespace
}  // namespace handrail
