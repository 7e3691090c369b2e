// The arm against Orocos KDL, whose chain is built from the Denavit-Hartenberg table only.
#include <gtest/gtest.h>

#include "tests/support/arm_samples.h"
#include "tests/support/kdl_arm.h"

namespace handrail {
namespace {

constexpr int kSamples = 100'000;
constexpr std::uint64_t kSeed = 571;

TEST(KinematicsAgainstKdl, ForwardAgreesAtTheFlangeAndAtTheHexKey) {
  for (const double d6 : {kFlangeLength, kHexKeyLength}) {
    std::mt19937_64 random(kSeed);
    test::KdlForward kdl(d6 / kMm);
    double worst_position = 0.0, worst_rotation = 0.0;
    for (int n = 0; n < kSamples; ++n) {
      const JointVector q = test::random_joints(random);
      const Pose ours = forward({.d6 = d6, .X_AT = {}}, q), theirs = kdl(q);
      worst_position = std::max(worst_position, test::position_error(ours, theirs));
      worst_rotation = std::max(worst_rotation, test::rotation_error(ours, theirs));
    }
    EXPECT_LT(worst_position, 1e-14) << "seed " << kSeed;
    // KDL turns its matrix into a quaternion, which loses digits where two components are small.
    EXPECT_LT(worst_rotation, 1e-12) << "seed " << kSeed;
  }
}

TEST(KinematicsAgainstKdl, EverySolutionReachesThePoseByKdlsForward) {
  std::mt19937_64 random(kSeed + 1);
  test::KdlForward kdl;
  double worst_position = 0.0, worst_rotation = 0.0;
  int unsolved = 0;
  for (int n = 0; n < kSamples; ++n) {
    const JointVector q = test::random_joints(random);
    const Pose X = kdl(q);
    InverseSolutions found;
    inverse_all({}, X, q, found);
    if (found.count == 0) ++unsolved;
    for (std::size_t i = 0; i < static_cast<std::size_t>(found.count); ++i) {
      const Pose back = kdl(found.q[i]);
      worst_position = std::max(worst_position, test::position_error(back, X));
      worst_rotation = std::max(worst_rotation, test::rotation_error(back, X));
    }
  }
  EXPECT_EQ(unsolved, 0) << "seed " << kSeed + 1;
  EXPECT_LT(worst_position, 1e-9) << "seed " << kSeed + 1;
  EXPECT_LT(worst_rotation, 1e-9) << "seed " << kSeed + 1;
}

TEST(KinematicsAgainstKdl, TheNearSolutionRecoversTheJointsOfKdlsPose) {
  std::mt19937_64 random(kSeed + 2);
  test::KdlForward kdl;
  double worst = 0.0;
  for (int n = 0; n < kSamples; ++n) {
    const JointVector q = test::random_joints(random);
    JointVector found;
    ASSERT_EQ(inverse_near({}, kdl(q), q, found), InverseStatus::kOk) << q.transpose() / kDeg;
    const SingularityMargin m = singularity_margin({}, q);
    const double margin = std::min({m.wrist, m.shoulder, m.elbow});
    worst = std::max(worst, (found - q).cwiseAbs().maxCoeff() * margin);
  }
  EXPECT_LT(worst, 1e-12) << "seed " << kSeed + 2;
}

}  // namespace
}  // namespace handrail
