#include "server/kinematics/jacobian.h"

#include <gtest/gtest.h>

#include "tests/support/arm_samples.h"

namespace handrail {
namespace {

// On the flange's axis, and mounted aside.
class TipJacobianOf : public testing::TestWithParam<bool> {};

TEST_P(TipJacobianOf, AnArmIsWhatForwardKinematicsDoesWhenAJointTurnsALittle) {
  std::mt19937_64 random(9);
  const ArmGeometry arm = GetParam() ? test::bent_arm() : ArmGeometry();
  constexpr double kTurn = 1e-6;
  for (int run = 0; run < 500; ++run) {
    const JointVector q = test::random_joints(random);
    const TipJacobian J = tip_jacobian(arm, q);
    for (int i = 0; i < kJoints; ++i) {
      JointVector less = q, more = q;
      less[i] -= kTurn;
      more[i] += kTurn;
      const Pose a = forward(arm, less), b = forward(arm, more);
      ASSERT_LT((J.linear.col(i) - (b.p - a.p) / (2.0 * kTurn)).norm(), 1e-8);
      ASSERT_LT((J.angular.col(i) - rotation_log(b.q * a.q.conjugate()) / (2.0 * kTurn)).norm(),
                1e-8);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(StraightAndBent, TipJacobianOf, testing::Bool());

}  // namespace
}  // namespace handrail
