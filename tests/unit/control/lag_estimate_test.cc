#include "server/control/lag_estimate.h"

#include <gtest/gtest.h>

#include <cmath>

namespace handrail {
namespace {

TEST(LagEstimate, FindsTheLagOfAnArmThatMovesAndKeepsItWhileItStands) {
  constexpr double kCycle = 0.0071;  // [s]
  for (const double lag : {0.02, 0.045, 0.08}) {
    LagEstimate estimate;
    EXPECT_DOUBLE_EQ(estimate.lag(), 0.06);
    JointVector q = JointVector::Zero(), arm = q;
    for (int i = 0; i < 3000; ++i) {
      for (int j = 0; j < kJoints; ++j) q[j] = 0.3 * std::sin((0.4 + 0.1 * j) * i * kCycle);
      arm += (1.0 - std::exp(-kCycle / lag)) * (q - arm);
      estimate.add(q, arm, kCycle);
    }
    EXPECT_NEAR(estimate.lag(), lag, 0.006) << lag;
    const double before = estimate.lag();
    for (int i = 0; i < 1000; ++i) estimate.add(q, arm, kCycle);
    EXPECT_EQ(estimate.lag(), before);
  }
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

// Moved by hand or put there while nothing was judged.
TEST(LagEstimate, WhereItIsPutIsNoMotion) {
  LagEstimate estimate;
  const JointVector q = JointVector::Constant(1.0);
  estimate.restart(q);
  estimate.add(q, q, 0.0071);
  EXPECT_DOUBLE_EQ(estimate.lag(), 0.06);
}

}  // namespace
}  // namespace handrail
