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
    JointVector q = JointVector::Zero(), step = q, arm = q;
    for (int i = 0; i < 3000; ++i) {
      const JointVector last = q;
      for (int j = 0; j < kJoints; ++j) q[j] = 0.3 * std::sin((0.4 + 0.1 * j) * i * kCycle);
      step = q - last;
      arm += (1.0 - std::exp(-kCycle / lag)) * (q - arm);
      estimate.add(q, step, arm, kCycle);
    }
    EXPECT_NEAR(estimate.lag(), lag, 0.006) << lag;
    const double before = estimate.lag();
    for (int i = 0; i < 1000; ++i) estimate.add(q, JointVector::Zero(), q, kCycle);
    EXPECT_EQ(estimate.lag(), before);
  }
}

TEST(LagEstimate, NeverLeavesWhatAnArmCanHave) {
  LagEstimate estimate;
  const JointVector step = JointVector::Constant(0.01), q = JointVector::Zero();
  for (int i = 0; i < 1000; ++i) estimate.add(q, step, JointVector::Constant(-10.0), 0.0071);
  EXPECT_DOUBLE_EQ(estimate.lag(), 0.1);
  for (int i = 0; i < 9000; ++i) estimate.add(q, step, JointVector::Constant(10.0), 0.0071);
  EXPECT_DOUBLE_EQ(estimate.lag(), 0.0);
}

}  // namespace
}  // namespace handrail
