#include "server/kinematics/tip_place.h"

#include <gtest/gtest.h>

#include "server/kinematics/jacobian.h"
#include "tests/support/arm_samples.h"

namespace handrail {
namespace {

// On the flange's axis, and mounted aside.
class TipPlaceOf : public testing::TestWithParam<bool> {};

TEST_P(TipPlaceOf, AnArmTurnedStepByStepIsWhereTheJointsAre) {
  const ArmGeometry arm = GetParam() ? test::bent_arm() : ArmGeometry();
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> step(-0.19, 0.19);
  for (int run = 0; run < 200; ++run) {
    JointVector q = test::random_joints(random);
    TipPlace tip(arm, q);
    for (int k = 0; k < 64; ++k) {
      JointVector by;
      for (int i = 0; i < kJoints; ++i) by[i] = step(random);
      q += by;
      tip.turn(by);
      ASSERT_LT((tip.p() - forward(arm, q).p).norm(), 1e-12) << "run " << run << " step " << k;
      const TipJacobian turned = tip.jacobian(), there = tip_jacobian(arm, q);
      ASSERT_LT((turned.linear - there.linear).cwiseAbs().maxCoeff(), 1e-12);
      ASSERT_LT((turned.angular - there.angular).cwiseAbs().maxCoeff(), 1e-12);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(StraightAndBent, TipPlaceOf, testing::Bool());

}  // namespace
}  // namespace handrail
