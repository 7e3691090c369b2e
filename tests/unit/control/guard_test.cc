#include "server/control/guard.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/arm_samples.h"

namespace handrail {
namespace {

constexpr double kDt = 0.0071;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

const JointLimits& limits() { return rv2a_limits(); }
JointVector home() { return test::joints_deg(0, 0, 90, 0, 90, 0); }
JointVector top_step() { return limits().max_speed * kDt; }
JointVector change() { return limits().max_acceleration * (kDt * kDt); }

TEST(LongestStoppable, LeavesJustEnoughRoomForTheStepsThatFollow) {
  for (const double a : {0.1, 1.0, 3.0}) {
    for (double room = 0.0; room < 100.0; room += 0.37) {
      const double first = longest_stoppable(room, a);
      double travelled = 0.0;
      for (double step = first; step > 0.0; step -= a) travelled += step;
      EXPECT_LE(travelled, room + 1e-9) << room << " " << a;
      // And not much less than could be.
      EXPECT_GE(travelled, room - std::max(a, 0.15 * first) - 1e-9);
    }
  }
  EXPECT_EQ(longest_stoppable(-1.0, 0.1), 0.0);
}

TEST(Guard, LetsWhatIsWithinTheLimitsPassBitForBit) {
  const JointVector wanted = home() + 0.9 * change();
  const Guarded out = guard(limits(), home(), JointVector::Zero(), wanted, kDt);
  EXPECT_EQ(out.q, wanted);
  EXPECT_EQ(out.reason, Reason::kNone);
}

TEST(Guard, AWildJumpBecomesTheFurthestSafeStepAndSaysSo) {
  const Guarded out =
      guard(limits(), home(), JointVector::Zero(), test::joints_deg(90, 90, 60, 90, 0, 90), kDt);
  EXPECT_EQ(out.reason, Reason::kGuard);
  const JointVector step = out.q - home();
  EXPECT_LE((step.cwiseAbs().array() / change().array()).maxCoeff(), 1.0 + 1e-9);
  EXPECT_GT((step.cwiseAbs().array() / change().array()).maxCoeff(), 1.0 - 1e-9);
}

TEST(Guard, AtTopSpeedTheStepIsNoLonger) {
  const JointVector last = top_step();
  const Guarded out = guard(limits(), home(), last, home() + 1.01 * last, kDt);
  EXPECT_EQ(out.reason, Reason::kGuard);
  EXPECT_LE(((out.q - home()).array() / top_step().array()).maxCoeff(), 1.0 + 1e-9);
}

TEST(Guard, WhatIsNotANumberBrakes) {
  for (const double bad : {kNaN, std::numeric_limits<double>::infinity(), -1e308}) {
    for (int joint = 0; joint < kJoints; ++joint) {
      const JointVector last = 0.5 * top_step();
      JointVector wanted = home() + last;
      wanted[joint] = bad;
      const Guarded out = guard(limits(), home(), last, wanted, kDt);
      ASSERT_TRUE(out.q.allFinite());
      EXPECT_EQ(out.reason, Reason::kGuard);
      const JointVector step = out.q - home();
      EXPECT_LE((step - last).cwiseQuotient(change()).cwiseAbs().maxCoeff(), 1.0 + 1e-9);
      EXPECT_LT(step.norm(), last.norm());
    }
  }
}

TEST(Guard, AJointDrivenAtItsEndStopsShortOfItAndMayAlwaysComeBack) {
  JointVector q = home(), last = JointVector::Zero();
  const auto drive = [&](const JointVector& toward, int cycles) {
    for (int i = 0; i < cycles; ++i) {
      const Guarded out = guard(limits(), q, last, toward, kDt);
      last = out.q - q;
      q = out.q;
      ASSERT_LE((q - limits().upper).maxCoeff(), 1e-9);
    }
  };
  JointVector beyond = home();
  beyond[4] = 200 * kDeg;
  drive(beyond, 300);
  EXPECT_NEAR(q[4], limits().upper[4], 1e-3);
  drive(home(), 300);
  EXPECT_LT((q - home()).norm(), 1e-3);
}

TEST(Guard, AJointFoundOutsideItsRangeMayOnlyComeBack) {
  JointVector outside = home();
  outside[2] = limits().upper[2] + 0.01;
  JointVector further = outside;
  further[2] += 1e-4;
  EXPECT_EQ(guard(limits(), outside, JointVector::Zero(), further, kDt).q, outside);
  JointVector back = outside;
  back[2] -= 1e-4;
  EXPECT_EQ(guard(limits(), outside, JointVector::Zero(), back, kDt).q, back);
}

TEST(StepBox, IsNeverEmptyAndHoldsItsBrake) {
  std::mt19937_64 random(61);
  for (int i = 0; i < 20000; ++i) {
    const JointVector q = 1.02 * test::random_joints(random);
    const JointVector last =
        top_step().cwiseProduct(1.2 * test::random_joints(random).cwiseQuotient(limits().upper));
    const StepBox box = step_box(limits(), q, last, kDt, 0.97, 0.5);
    ASSERT_TRUE((box.high - box.low).minCoeff() >= 0.0);
    ASSERT_TRUE(box.contains(box.brake));
  }
}

}  // namespace
}  // namespace handrail
