// The default bumper in the slave's step: with stop plans, tools and a sensor that lies.
#include <gtest/gtest.h>

#include <deque>

#include "tests/unit/constraint/tool_samples.h"
#include "tests/unit/follow/follow_floor.h"

namespace handrail {
namespace {

using test::Dice;
using test::Floor;
using test::FollowRig;
constexpr double kSame = 1e-9;  // [m]

TEST(FollowBumper, InFreeAirBothFormsMoveTheArmAlikeBitForBit) {
  FollowRig a, b;
  b.settings.bumper.form = BumperSettings::Form::kPublished;
  a.engage();
  b.engage();
  Dice dice(81);
  Pose X = a.tip;
  for (int i = 0; i < 500; ++i) {
    X.p += dice.within(3e-3);
    a.in.f_E_T.force = b.in.f_E_T.force = dice.within(0.2);
    a.follow(X);
    b.follow(X);
    ASSERT_EQ(a.joints(), b.joints()) << i;
  }
}

// A push stops under the threshold and is not let in again, and the way out is free at once.
TEST(FollowBumper, ThePushIsHeldUnderTheThresholdAndTheRestPlaceNeverGoesFurtherInAboveIt) {
  for (const double k : {5e3, 30e3, 60e3}) {
    for (const int late : {0, 6}) {
      Floor floor(k, late);
      double most = 0.0, inward = 0.0;
      for (int i = 0; i < 2000; ++i) {
        const Vec3 before = floor.rest();
        floor.down(0.03, 0.02);
        most = std::max(most, floor.force);
        if (floor.force > 50.0) {
          inward = std::max(inward, before.z() - floor.rest().z());
        }
      }
      EXPECT_LT(inward, 1e-6) << k << ' ' << late;
      // f_th + k v (D + 2.5 T), and the way to brake from 30 mm/s, 0.9 mm.
      const double D = late * 0.0071 + 0.001;
      EXPECT_LT(most, 50.0 + k * (0.03 * (D + 2.5 * 0.0071) + 0.9e-3)) << k << ' ' << late;
      EXPECT_NEAR(floor.force, 47.5, 2.5) << k << ' ' << late;
      EXPECT_GT(floor.rig.state.bumper.stiffness, 0.9 * k) << late;
      // The last place without contact is where the arm was, not where it was told to be.
      EXPECT_NEAR(floor.rig.state.bumper.p_touch.z(), floor.surface - 5.0 / k, 5.0 / k + 0.3e-3);
      EXPECT_EQ(floor.rig.out.link.reason, Reason::kBumper);
      EXPECT_EQ(floor.rig.out.link.state, SessionState::kEngaged);
      EXPECT_TRUE(floor.rig.watch.kept());
      floor.X.p.z() = floor.surface + 0.01;
      for (int i = 0; i < 200; ++i) floor.cycle();
      EXPECT_NEAR(floor.rig.tip.p.z(), floor.X.p.z(), kSame);
    }
  }
}

// A key in its socket, turned while the hand strays: walls and bottom push at once, and an arm that
// turns fast comes to rest elsewhere than where it is told to go. That must not lead it out.
TEST(FollowBumper, AKeyThatIsTurnedHardInItsSocketStaysInIt) {
  const auto run = [](double promise, double stray, double begin, double press) {
    FollowRig rig;
    rig.settings.bumper.promise = promise;
    rig.settings.bumper.stiffest = 35e3;
    rig.engage();
    const Pose X_first = rig.state.motion.X_ST;
    std::deque<JointVector> late(7, rig.joints());
    double out = 0.0, hardest = 0.0;
    for (int i = 0; i < 330; ++i) {
      const double t = i * rig.settings.motion->dt;
      const double angle = 110.0 * kDeg * std::max(0.0, t - 0.7);
      const Vec3 hand(stray * std::sin(angle + begin), 0.35 * stray * std::sin(2.0 * angle),
                      -press);
      const Pose X{X_first.p + std::min(1.0, t / 0.4) * hand,
                   rotation_exp(-angle * Vec3::UnitZ()) * X_first.q};
      const Pose tip = forward(rig.settings.motion->arm, late.front());
      const Vec3 bent = tip.p - X_first.p;
      const Vec3 f_S(-7e3 * bent.x(), -7e3 * bent.y(), 30e3 * std::max(0.0, -bent.z()));
      hardest = std::max(hardest, f_S.norm());
      rig.in.q_measured = late.front();
      rig.in.f_E_T.force = tip.q.conjugate() * f_S;
      rig.follow(X);
      late.push_back(rig.joints());
      late.pop_front();
      out = std::max(out, rig.state.motion.X_ST.p.z() - X_first.p.z());
    }
    EXPECT_GT(hardest, 45.0);
    EXPECT_LT(hardest, 70.0);
    EXPECT_LT(out, 0.1e-3) << promise << ' ' << stray << ' ' << begin << ' ' << press;
  };
  for (const double promise : {0.0, 200.0}) {
    for (const double stray : {4e-3, 6e-3, 9e-3}) {
      for (const double begin : {-0.8, -0.4, 0.0}) {
        for (const double press : {2e-3, 3e-3, 4e-3}) run(promise, stray, begin, press);
      }
    }
  }
}

// Nothing is known of the contact any more, so nothing goes in; out is free.
TEST(FollowBumper, ASensorThatSticksOrFallsSilentInContactDoesNotLetTheCommandIn) {
  for (const bool sticks : {true, false}) {
    for (const int late : {0, 6}) {
      Floor floor(30e3, late);
      floor.rig.settings.sensor_required = false;
      floor.noise = 0.05;
      for (int i = 0; i < 200; ++i) floor.cycle();
      for (int i = 0; i < 500; ++i) floor.down(0.01, 0.02);
      ASSERT_TRUE(floor.rig.state.bumper.touching());
      const double stuck_at = floor.force, before = floor.rig.tip.p.z();
      for (int i = 0; i < 500; ++i) {
        floor.rig.in.q_measured = floor.q.front();
        floor.rig.in.wrench_valid = sticks;
        floor.rig.in.f_E_T.force.z() = -stuck_at;
        floor.rig.follow(floor.X);
        floor.q.push_back(floor.rig.joints());
        floor.q.pop_front();
      }
      EXPECT_FALSE(floor.rig.out.link.has_wrench) << sticks << late;
      EXPECT_NEAR(floor.rig.tip.p.z(), before, 0.3e-3) << sticks << late;
      floor.X.p.z() = floor.surface + 0.01;
      for (int i = 0; i < 300; ++i) {
        floor.rig.in.q_measured = floor.rig.joints();
        floor.rig.follow(floor.X);
      }
      EXPECT_NEAR(floor.rig.tip.p.z(), floor.X.p.z(), kSame) << sticks << late;
    }
  }
}

TEST(FollowBumper, BumperStageOfTheLedgerIsTheContactOffset) {
  Floor floor(30e3);
  for (int i = 0; i < 500; ++i) floor.down(0.03, 0.02);
  const FollowLedger& ledger = floor.rig.out.link.ledger;
  const int stage = static_cast<int>(FollowStage::kBumper);
  const double offset = floor.rig.tip.p.z() - floor.X.p.z();
  EXPECT_GT(offset, 0.015);
  EXPECT_NEAR(ledger.off_S(2, stage), offset, 1e-6);
  EXPECT_EQ(ledger.why[static_cast<std::size_t>(stage)], Reason::kBumper);
}

TEST(FollowBumper, ReliefGoesBackOnAOneWayLine) {
  Floor floor(60e3, 6);
  floor.rig.in.master.position_tool = test::line_along(floor.rig.tip.p, Vec3(0, 0, -1), true);
  floor.rig.in.master.position_tool.epoch = 1;
  double most = 0.0;
  for (int i = 0; i < 1500; ++i) {
    floor.down(0.06, 0.02);
    most = std::max(most, floor.force);
  }
  EXPECT_GT(most, 80.0);
  EXPECT_NEAR(floor.force, 47.5, 2.5);
  EXPECT_TRUE(floor.rig.watch.kept());
}

TEST(FollowBumper, ASurfaceThatComesUpTakesTheTipOffItsLine) {
  Floor floor(30e3, 6);
  floor.rig.in.master.position_tool = test::line_along(floor.rig.tip.p, Vec3::UnitX(), false);
  floor.rig.in.master.position_tool.epoch = 1;
  for (int i = 0; i < 1000; ++i) {
    if (i < 500) floor.surface += 1e-5;
    floor.cycle();
  }
  EXPECT_NEAR(floor.surface - floor.X.p.z(), 3e-3, 1e-6);
  EXPECT_NEAR(floor.force, 47.5, 2.5);
}

TEST(FollowBumper, AnApproachIsAsFastAsThePromiseAllows) {
  for (const int late : {0, 6}) {
    Floor floor(60e3, late);
    floor.rig.settings.bumper.promise = 200.0;
    floor.surface -= 0.05;
    double most = 0.0, fastest = 0.0, touched_at = 0.0, allowed = 0.0;
    bool slowed = false;
    for (int i = 0; i < 1500; ++i) {
      const double height = floor.height();
      floor.down(0.25, 0.05);
      const FollowLedger& ledger = floor.rig.out.link.ledger;
      slowed |= floor.rig.out.link.reason == Reason::kApproach &&
                ledger.why[static_cast<std::size_t>(FollowStage::kBumper)] == Reason::kApproach;
      most = std::max(most, floor.force);
      const double speed = (height - floor.height()) / floor.rig.settings.motion->dt;
      fastest = std::max(fastest, speed);
      if (floor.force > 0.0) continue;
      const FollowSettings& settings = floor.rig.settings;
      const double delay = floor.rig.state.lag.lag() + settings.bumper.sensor_lag;
      allowed = approach_speed(settings.bumper, 150.0, delay, settings.motion->dt);
      touched_at = speed;
    }
    EXPECT_TRUE(slowed);
    EXPECT_NEAR(touched_at, allowed, 0.02 * allowed) << late;
    EXPECT_LT(fastest, 1.1 * allowed) << late;
    EXPECT_GT(most, 80.0) << late;
    EXPECT_LT(most, 200.0) << late;
  }
}

TEST(FollowBumper, ALostReadingIsNoInwardStep) {
  Floor floor(10e3, 6);
  while (floor.force < 20.0) floor.down(0.01, 0.02);
  ASSERT_TRUE(floor.rig.state.bumper.touching());
  double before = floor.rest().z();
  floor.down(0.01, 0.02);
  EXPECT_LT(floor.rest().z(), before - 1e-5);
  floor.rig.in.wrench_valid = false;
  for (int i = 0; i < 2; ++i) {
    before = floor.rest().z();
    floor.down(0.01, 0.02);
    EXPECT_GT(floor.rest().z(), before - 1e-9);
  }
}

// Without a sensor that it needs, the arm goes on as if nothing were touched; so it does when
// placed anew.
TEST(FollowBumper, WhatWasTouchedIsForgottenWithTheSessionAndThePlace) {
  for (const int what : {1, 2}) {
    Floor floor(10e3);
    floor.rig.settings.sensor_required = false;
    while (floor.force < 20.0) floor.down(0.01, 0.02);
    ASSERT_TRUE(floor.rig.state.bumper.touching());
    if (what == 1) floor.rig.in.master.desired = Desired::kOff;
    if (what == 2) place(floor.rig.settings, floor.rig.joints(), floor.rig.state);
    floor.stiffness = 0.0;
    for (int i = 0; i < (what == 2 ? 1 : 3); ++i) floor.cycle();
    EXPECT_EQ(floor.rig.state.bumper.phase, BumperState::Phase::kFree) << what;
  }
}

TEST(FollowBumper, WrongSignStopsWithin200Ms) {
  for (const double speed : {0.005, 0.02, 0.05}) {
    Floor floor(20e3, 6);
    floor.sign = -1.0;
    int felt = 0;
    for (int i = 0; i < 1000 && floor.rig.out.link.state == SessionState::kEngaged; ++i) {
      floor.down(speed, 0.02);
      if (floor.force > 10.0) ++felt;
    }
    EXPECT_EQ(floor.rig.out.link.fault, Reason::kSensorSign) << speed;
    EXPECT_LT(felt * 0.0071, 0.2) << speed;
    for (int i = 0; i < 100; ++i) floor.cycle();
    EXPECT_TRUE(standing(floor.rig.state.motion));
  }
}

// What is told as the way out leads in: it must not be hurried along.
TEST(FollowBumper, AWrongSignIsFoundBeforeThePromisedForceIsPassed) {
  for (const double speed : {0.02, 0.05, 0.25}) {
    Floor floor(57e3, 6);
    floor.sign = -1.0;
    floor.surface -= 0.05;
    floor.rig.settings.bumper.promise = 200.0;
    double most = 0.0;
    for (int i = 0; i < 1500; ++i) {
      floor.down(speed, 0.05);
      most = std::max(most, floor.force);
    }
    EXPECT_EQ(floor.rig.out.link.fault, Reason::kSensorSign) << speed;
    EXPECT_LT(most, 200.0) << speed;
  }
}

TEST(FollowBumper, AForceThatBackingOffDoesNotRelieveStopsTheArm) {
  Floor floor(0.0);
  floor.rig.in.f_E_T.force = {100.0, 0.0, 0.0};
  int cycles = 0;
  for (; cycles < 100 && floor.rig.out.link.state == SessionState::kEngaged; ++cycles) {
    floor.rig.in.f_E_T.force.x() += 1e-6;  // not the same bits: that would be a stuck sensor
    floor.rig.follow(floor.X);
  }
  EXPECT_EQ(floor.rig.out.link.fault, Reason::kContactUnrelieved);
  EXPECT_NEAR(cycles * 0.0071, 0.2, 0.03);
  // Reset and engaged again, it is judged anew.
  floor.rig.in.master.fault_reset = floor.rig.out.link.fault_epoch;
  floor.rig.in.master.state = SessionState::kOff;
  floor.rig.in.master.desired = Desired::kOff;
  while (!standing(floor.rig.state.motion)) floor.rig.cycle();
  floor.rig.cycle();
  floor.rig.engage();
  floor.X = floor.rig.state.motion.X_ST;
  for (int i = 0; i < 20; ++i) {
    floor.rig.in.f_E_T.force.x() += 1e-6;
    floor.rig.follow(floor.X);
  }
  EXPECT_EQ(floor.rig.out.link.state, SessionState::kEngaged);
}

TEST(FollowBumper, AHandThatComesAndGoesOnASurfaceIsNoFaultOfTheSensor) {
  Floor floor(30e3, 6);
  for (int i = 0; i < 3000; ++i) {
    const double t = i * floor.rig.settings.motion->dt;
    floor.X.p.z() = floor.surface - 2e-3 * std::sin(3.0 * t) - 2e-3 * std::sin(7.3 * t);
    floor.cycle();
    ASSERT_EQ(floor.rig.out.link.state, SessionState::kEngaged) << i;
  }
}

}  // namespace
}  // namespace handrail
