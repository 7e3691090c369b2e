#include "server/follow/lag_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "server/follow/monitors.h"

namespace handrail {
namespace {

constexpr double kLagCycle = 0.0071;  // [s]
constexpr double kLag = 0.045;        // of the arm below [s]

// An arm behind a first-order lag, whose joints swing.
struct Swinging {
  LagEstimate estimate;
  JointVector q = JointVector::Zero(), arm = q;
  double lag = kLag;
  int i = 0;
  // What is measured instead of `arm` in cycle i.
  std::function<JointVector(int i, const JointVector& arm)> says;

  explicit Swinging(double lag_in = kLag) : lag(lag_in) {}
  void pass(int cycles) {
    for (const int end = i + cycles; i < end; ++i) {
      for (int j = 0; j < kJoints; ++j) q[j] = 0.3 * std::sin((0.4 + 0.1 * j) * i * kLagCycle);
      arm += (1.0 - std::exp(-kLagCycle / lag)) * (q - arm);
      estimate.add(q, says ? says(i, arm) : arm, kLagCycle);
    }
  }
};

TEST(LagEstimate, FindsTheLagOfAnArmThatMovesAndKeepsItWhileItStands) {
  for (const double lag : {0.02, 0.045, 0.08}) {
    Swinging run(lag);
    EXPECT_DOUBLE_EQ(run.estimate.lag(), LagEstimate::kMost);
    run.pass(3000);
    // A cycle: what is commanded is on its way for half of one.
    EXPECT_NEAR(run.estimate.lag(), lag, 0.006) << lag;
    const double before = run.estimate.lag();
    for (int i = 0; i < 1000; ++i) run.estimate.add(run.q, run.arm, kLagCycle);
    EXPECT_EQ(run.estimate.lag(), before);
  }
}

TEST(LagEstimate, BeginsWithTheSlowestArmThatIsTakenToFollow) {
  EXPECT_DOUBLE_EQ(LagEstimate::kMost, FollowingSettings().slowest);
}

TEST(LagEstimate, HalfASecondOfMotionAsSlowAsACarefulApproachIsEnough) {
  // 20 mm/s of a tip half a metre away.
  const JointVector step = 0.04 * kLagCycle * JointVector::Unit(1);
  LagEstimate estimate;
  constexpr int kBehind = 6;  // cycles
  for (int i = 0; i < 70 + kBehind; ++i) {
    estimate.add(i * step, std::max(0, i - kBehind) * step, kLagCycle);
  }
  EXPECT_NEAR(estimate.lag(), kBehind * kLagCycle, 1e-9);
}

TEST(LagEstimate, NeverLeavesWhatAnArmCanHave) {
  LagEstimate estimate;
  const JointVector step = JointVector::Constant(0.01), far = JointVector::Constant(10.0);
  JointVector q = JointVector::Zero();
  for (int i = 0; i < 1000; ++i, q += step) estimate.add(q + far, q, 0.0071);
  EXPECT_DOUBLE_EQ(estimate.lag(), 0.1);
  for (int i = 0; i < 9000; ++i, q += step) estimate.add(q - far, q, 0.0071);
  EXPECT_DOUBLE_EQ(estimate.lag(), 0.0);
}

// What was commanded a moment ago is not yet to be seen: that is no quick arm.
TEST(LagEstimate, AnArmThatHasJustBegunToMoveIsNotTakenForAQuickOne) {
  for (const int late : {3, 6, 9}) {
    LagEstimate estimate;
    const JointVector step = JointVector::Constant(2e-3);
    for (int i = 0; i < 100; ++i) {
      estimate.add(i * step, std::max(0, i - late) * step, 0.0071);
      EXPECT_GE(estimate.lag(), std::min(late * 0.0071, 0.06) - 1e-9) << late << ' ' << i;
    }
  }
}

// As far as an encoder may be off and be believed, and any part of it.
TEST(LagEstimate, ReadingsThatJumpForACycleDoNotMakeTheArmQuicker) {
  for (const double jump : {1e-3, 3e-3, 0.01, 0.03, 0.09, -0.09}) {
    for (const int each : {2, 3, 5, 100}) {
      Swinging run;
      run.pass(1000);
      const double before = run.estimate.lag();
      run.says = [&](int i, const JointVector& arm) {
        return JointVector(arm + (i % each == 0 ? jump : 0.0) * JointVector::Unit(2));
      };
      for (int i = 0; i < 1000; ++i) {
        run.pass(1);
        // A tenth of the lag is a twentieth of the speed that a promise allows.
        ASSERT_GT(run.estimate.lag(), 0.9 * before) << jump << " each " << each << ' ' << i;
      }
    }
  }
}

TEST(LagEstimate, AReadingThatJumpsAndStaysIsNoMotion) {
  for (const double jump : {0.3, -0.3}) {
    Swinging run;
    run.pass(1000);
    const double before = run.estimate.lag();
    run.says = [&](int i, const JointVector& arm) {
      return JointVector(arm + (i < 1004 ? jump : 0.0) * JointVector::Unit(2));
    };
    run.pass(10);
    EXPECT_GT(run.estimate.lag(), 0.9 * before) << jump;
  }
}

TEST(LagEstimate, RepliesThatAreMissingDoNotMakeTheArmQuicker) {
  for (const int each : {2, 3, 4, 10, 20}) {
    Swinging run;
    run.pass(1000);
    const double before = run.estimate.lag();
    JointVector last = run.arm;
    run.says = [&](int i, const JointVector& arm) {
      if (i % each != 0) last = arm;
      return last;
    };
    for (int i = 0; i < 2000; ++i) {
      run.pass(1);
      ASSERT_GT(run.estimate.lag(), 0.95 * before) << each << ' ' << i;
    }
  }
}

TEST(LagEstimate, AnArmThatHasBecomeSlowIsBelievedAtOnce) {
  Swinging run(0.02);
  run.pass(1000);
  run.lag = 0.09;
  run.pass(70);
  EXPECT_GT(run.estimate.lag(), 0.08);
}

// Moved by hand or put there while nothing was judged, and the arm may be another.
TEST(LagEstimate, WhereItIsPutIsNoMotionAndNothingIsKnownOfTheArm) {
  Swinging run;
  run.pass(1000);
  EXPECT_LT(run.estimate.lag(), 0.05);
  const JointVector q = JointVector::Constant(1.0);
  run.estimate.restart(q);
  EXPECT_DOUBLE_EQ(run.estimate.lag(), LagEstimate::kMost);
  run.estimate.add(q, q, kLagCycle);
  EXPECT_DOUBLE_EQ(run.estimate.lag(), LagEstimate::kMost);
}

}  // namespace
}  // namespace handrail
