#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "tests/support/arm_samples.h"
#include "tests/support/no_allocation.h"

namespace handrail {
namespace {

using test::joints_deg;
using test::turn_free_distance;

constexpr std::uint64_t kSeed = 20240611;

TEST(InverseAll, SolvesEveryReachablePoseAndEachBranchMapsBack) {
  std::mt19937_64 random(kSeed);
  const ArmGeometry arm;
  double worst_position = 0.0, worst_rotation = 0.0, worst_seed = 0.0;
  int unsolved = 0;
  for (int n = 0; n < 100'000; ++n) {
    const JointVector q = test::random_joints(random);
    const Pose X = forward(arm, q);
    InverseSolutions found;
    inverse_all(arm, X, q, found);
    if (found.count == 0) ++unsolved;
    double nearest = 10.0;
    for (int i = 0; i < found.count; ++i) {
      const JointVector& solution = found.q[static_cast<std::size_t>(i)];
      const Pose back = forward(arm, solution);
      worst_position = std::max(worst_position, test::position_error(back, X));
      worst_rotation = std::max(worst_rotation, test::rotation_error(back, X));
      nearest = std::min(nearest, turn_free_distance(solution, q));
    }
    // Joint angles lose digits in proportion to the distance from a singular pose.
    const SingularityMargin m = singularity_margin(arm, q);
    worst_seed = std::max(worst_seed, nearest * std::min({m.wrist, m.shoulder, m.elbow}));
  }
  EXPECT_EQ(unsolved, 0) << "seed " << kSeed;
  EXPECT_LT(worst_position, 1e-14) << "seed " << kSeed;
  EXPECT_LT(worst_rotation, 1e-14) << "seed " << kSeed;
  EXPECT_LT(worst_seed, 1e-14) << "seed " << kSeed;
}

TEST(InverseAll, NamesTheBranchOfEachSolutionAndFindsNoBranchTwice) {
  std::mt19937_64 random(kSeed + 1);
  const ArmGeometry arm;
  int eight = 0;
  for (int n = 0; n < 5'000; ++n) {
    const JointVector q = test::random_joints(random);
    InverseSolutions found;
    inverse_all(arm, forward(arm, q), q, found);
    if (found.count == 8) ++eight;
    bool seen[2][2][2] = {};
    for (std::size_t i = 0; i < static_cast<std::size_t>(found.count); ++i) {
      const Branch& b = found.branch[i];
      EXPECT_EQ(b, branch_of(arm, found.q[i])) << "sample " << n << " of seed " << kSeed + 1;
      EXPECT_FALSE(seen[b.shoulder_back][b.elbow_down][b.wrist_flipped]);
      seen[b.shoulder_back][b.elbow_down][b.wrist_flipped] = true;
    }
    const Branch own = branch_of(arm, q);
    EXPECT_TRUE(seen[own.shoulder_back][own.elbow_down][own.wrist_flipped]);
  }
  EXPECT_GT(eight, 500) << "the samples should include poses with all eight solutions";
}

TEST(InverseAll, KeepsAnglesWithinHalfATurn) {
  std::mt19937_64 random(kSeed + 2);
  const double pi = std::numbers::pi;
  for (int n = 0; n < 5'000; ++n) {
    const JointVector q = test::random_joints(random);
    InverseSolutions found;
    inverse_all({}, forward({}, q), q, found);
    for (std::size_t i = 0; i < static_cast<std::size_t>(found.count); ++i) {
      EXPECT_GT(found.q[i].minCoeff(), -pi);
      EXPECT_LE(found.q[i].maxCoeff(), pi);
    }
  }
}

TEST(InverseAll, CallsTheHalfTurnPlusPiAlsoWhereRoundingSaysMinus) {
  const Pose behind{Vec3(-0.4, -0.0, 0.4),
                    Quat(0, 1, 0, 0)};  // the tool points down, J1 half a turn
  InverseSolutions found;
  inverse_all({}, behind, joints_deg(0, 0, 90, 0, 90, 0), found);
  ASSERT_GT(found.count, 0);
  EXPECT_EQ(found.q[0][0], std::numbers::pi);
  for (std::size_t i = 0; i < static_cast<std::size_t>(found.count); ++i) {
    EXPECT_GT(found.q[i].minCoeff(), -std::numbers::pi);
  }
}

TEST(InverseAll, FindsNothingOutOfReachOrForNumbersThatAreNone) {
  const JointVector seed = joints_deg(0, 0, 90, 0, 30, 0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Pose reachable = forward({}, seed);
  Pose far = reachable, bad_p = reachable, bad_q = reachable, no_q = reachable;
  far.p.x() += 1.0;
  bad_p.p.y() = nan;
  bad_q.q.w() = nan;
  no_q.q.coeffs().setZero();
  for (const Pose& X : {far, bad_p, bad_q, no_q}) {
    InverseSolutions found;
    found.count = 5;
    inverse_all({}, X, seed, found);
    EXPECT_EQ(found.count, 0);
    JointVector q = seed;
    EXPECT_EQ(inverse_near({}, X, seed, q), InverseStatus::kUnreachable);
    EXPECT_EQ(q, seed) << "an unreachable pose leaves the answer alone";
  }
}

TEST(InverseAll, FindsOnlyTheOtherShoulderWhenTheWristIsTooNearThisOne) {
  const JointVector seed = joints_deg(0, 0, 90, 0, 30, 0);
  Pose X = forward({}, seed);
  X.p = Vec3(0.1, 0, 0.35) + kHexKeyLength * (X.q * Vec3::UnitZ());  // wrist on the shoulder axis
  InverseSolutions found;
  inverse_all({}, X, seed, found);
  EXPECT_EQ(found.count, 4);
  for (std::size_t i = 0; i < static_cast<std::size_t>(found.count); ++i) {
    EXPECT_TRUE(found.branch[i].shoulder_back);
  }
  JointVector q;
  EXPECT_EQ(inverse_near({}, X, seed, q), InverseStatus::kUnreachable);
}

TEST(InverseAll, SolvesAPoseThatRoundingPutJustOutOfReach) {
  const double stretched_deg = std::atan2(0.130, 0.250) / kDeg;
  std::mt19937_64 random(kSeed + 3);
  std::uniform_real_distribution<double> any(-150.0, 150.0);
  for (int n = 0; n < 10'000; ++n) {
    const double elbow_deg = n % 2 == 0 ? stretched_deg : stretched_deg + 180.0;
    const JointVector q =
        joints_deg(any(random), any(random), elbow_deg, any(random), any(random), any(random));
    const Pose X = forward({}, q);
    InverseSolutions found;
    inverse_all({}, X, q, found);
    ASSERT_GT(found.count, 0) << q.transpose() / kDeg;
    double worst = 0.0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(found.count); ++i) {
      worst = std::max(worst, test::position_error(forward({}, found.q[i]), X));
    }
    EXPECT_LT(worst, 1e-11) << q.transpose() / kDeg;
  }
}

TEST(InverseAll, DoesNotMindTheQuaternionsSign) {
  const JointVector q = joints_deg(45, -20, 100, 30, 60, -40);
  Pose X = forward({}, q);
  X.q.coeffs() *= -1.0;
  InverseSolutions found;
  inverse_all({}, X, q, found);
  ASSERT_EQ(found.branch[0], Branch{});
  EXPECT_LT(turn_free_distance(found.q[0], q), 1e-13);
}

TEST(InverseNear, FindsTheSeedItselfAndTheSameAnswerAsInverseAll) {
  std::mt19937_64 random(kSeed + 4);
  std::normal_distribution<double> small(0.0, 0.02);
  for (int n = 0; n < 20'000; ++n) {
    const JointVector seed = test::random_joints(random);
    JointVector q = seed;
    const SingularityMargin m = singularity_margin({}, seed);
    ASSERT_EQ(inverse_near({}, forward({}, seed), seed, q), InverseStatus::kOk);
    const double margin = std::min({m.wrist, m.shoulder, m.elbow});
    EXPECT_LT((q - seed).cwiseAbs().maxCoeff() * margin, 1e-14) << seed.transpose() / kDeg;
    if (m.wrist < 0.15 || m.shoulder < 0.08) continue;

    JointVector moved = seed;
    for (int i = 0; i < kJoints; ++i) moved[i] += small(random);
    if (branch_of({}, moved) != branch_of({}, seed)) continue;
    const Pose X = forward({}, moved);
    ASSERT_EQ(inverse_near({}, X, seed, q), InverseStatus::kOk);
    EXPECT_LT((q - moved).cwiseAbs().maxCoeff() * margin, 1e-13) << seed.transpose() / kDeg;
  }
}

TEST(InverseNear, ReturnsEachOfTheSolutionsFromItself) {
  std::mt19937_64 random(kSeed + 6);
  int elbow_down = 0, shoulder_back = 0;
  for (int n = 0; n < 2'000; ++n) {
    const Pose X = forward({}, test::random_joints(random));
    InverseSolutions found;
    inverse_all({}, X, JointVector::Zero(), found);
    for (std::size_t i = 0; i < static_cast<std::size_t>(found.count); ++i) {
      const SingularityMargin m = singularity_margin({}, found.q[i]);
      JointVector q;
      ASSERT_EQ(inverse_near({}, X, found.q[i], q), InverseStatus::kOk);
      EXPECT_LT((q - found.q[i]).cwiseAbs().maxCoeff() * std::min({m.wrist, m.shoulder, m.elbow}),
                1e-14);
      elbow_down += found.branch[i].elbow_down;
      shoulder_back += found.branch[i].shoulder_back;
    }
  }
  EXPECT_GT(elbow_down, 1'000);
  EXPECT_GT(shoulder_back, 1'000);
}

TEST(InverseNear, KeepsTheSeedsWholeTurns) {
  const JointVector near = joints_deg(45, -20, 100, 150, 60, 170);
  const JointVector seed = near + joints_deg(360, -720, 360, 360, 1080, -360);
  JointVector q;
  ASSERT_EQ(inverse_near({}, forward({}, near), seed, q), InverseStatus::kOk);
  EXPECT_LT((q - seed).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(InverseNear, CrossesTheHalfTurnWithoutAJump) {
  JointVector seed = joints_deg(0, 0, 90, 0, 40, 179);
  for (int i = 0; i < 40; ++i) {
    JointVector next = seed;
    next[5] += 0.1 * kDeg;
    JointVector q;
    ASSERT_EQ(inverse_near({}, forward({}, next), seed, q), InverseStatus::kOk);
    ASSERT_LT((q - next).cwiseAbs().maxCoeff(), 1e-13);
    seed = q;
  }
  EXPECT_NEAR(seed[5] / kDeg, 183.0, 1e-9);
}

TEST(InverseNear, StaysOnTheSeedsBranchFarFromSingularPoses) {
  std::mt19937_64 random(kSeed + 5);
  int solved = 0;
  for (int n = 0; n < 20'000; ++n) {
    const JointVector seed = test::random_joints(random), other = test::random_joints(random);
    const SingularityMargin m = singularity_margin({}, seed);
    if (m.wrist < 0.15 || m.shoulder < 0.03) continue;
    JointVector q;
    if (inverse_near({}, forward({}, other), seed, q) != InverseStatus::kOk) continue;
    ++solved;
    EXPECT_EQ(branch_of({}, q), branch_of({}, seed));
    EXPECT_LT(test::position_error(forward({}, q), forward({}, other)), 1e-14);
    EXPECT_LE((q - seed).cwiseAbs().maxCoeff(), std::numbers::pi + 1e-12);
  }
  EXPECT_GT(solved, 5'000);
}

TEST(Kinematics, NeverTouchesTheHeap) {
  const ArmGeometry arm;
  const JointVector seed = joints_deg(45, -20, 100, 30, 60, -40);
  const JointLimits& limits = rv2a_limits();
  InverseSolutions found;
  JointVector q;
  double sum = 0.0;
  {
    test::NoAllocation guard("kinematics");
    const Pose X = forward(arm, seed);
    inverse_all(arm, X, seed, found);
    sum = inverse_near(arm, X, seed, q) == InverseStatus::kOk ? q.sum() : 0.0;
    sum += singularity_margin(arm, q).wrist + limits.upper[0];
  }
  EXPECT_NE(sum, 0.0);
  EXPECT_EQ(found.count, 8);
}

}  // namespace
}  // namespace handrail
