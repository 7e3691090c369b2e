#include "server/kinematics/reach.h"

#include <gtest/gtest.h>

#include "server/model/rv2a_limits.h"
#include "tests/support/arm_samples.h"

namespace handrail {
namespace {

using test::joints_deg;

const ArmGeometry kArm;
const JointVector kInside = JointVector::Constant(1e-4);

bool within_ranges(const JointVector& q) {
  const JointLimits& limits = rv2a_limits();
  return (q - limits.lower).minCoeff() > 0.0 && (limits.upper - q).minCoeff() > 0.0;
}

// Where it comes to step by step.
Reached reach(const TipSpace& space, const Pose& X, JointVector seed) {
  constexpr int kSteps = 400;
  Reached reached;
  for (int k = 0; k < kSteps; ++k) {
    reached = nearest_reachable(kArm, rv2a_limits(), space, X, seed, kInside);
    if (reached.joint < 0) break;
    seed = reached.q;
  }
  return reached;
}

TEST(Reach, APoseInReachIsItself) {
  std::mt19937_64 random(3);
  for (int run = 0; run < 500; ++run) {
    const JointVector seed = test::random_joints(random);
    JointVector q = seed + 0.1 * (test::random_joints(random) - seed);
    if (!within_ranges(seed) || !within_ranges(q)) continue;
    const Pose X = forward(kArm, q);
    const Reached r = reach({}, X, seed);
    if (r.joint >= 0) continue;  // on another way of standing than the seed's
    EXPECT_LT((forward(kArm, r.q).p - X.p).norm(), 1e-9);
    EXPECT_LT(angle_between(forward(kArm, r.q).q, X.q), 1e-8);
  }
}

// No point the arm takes with its orientation kept may be nearer: a search by small turns.
TEST(Reach, FarOutThePlaceYieldsToTheNearestWithTheOrientationKept) {
  const JointVector home = joints_deg(0, 0, 90, 0, 90, 0);
  const Pose A = forward(kArm, home);
  std::mt19937_64 random(5);
  std::normal_distribution<double> some;
  for (const Vec3& way : {Vec3(1, 0, 0), Vec3(0.6, 0.6, 0.2), Vec3(0.3, -0.2, 0.9)}) {
    const Pose X{A.p + 1.2 * way, A.q};
    const Reached r = reach({}, X, home);
    EXPECT_EQ(r.joint, 2);
    EXPECT_TRUE(r.arm);
    EXPECT_TRUE(within_ranges(r.q));
    EXPECT_LT(angle_between(r.X.q, A.q), 1e-6);
    const double off = (r.X.p - X.p).norm();
    for (int run = 0; run < 2000; ++run) {
      const Pose near{r.X.p + 0.01 * Vec3(some(random), some(random), some(random)), A.q};
      JointVector q;
      if (inverse_near(kArm, near, r.q, q) != InverseStatus::kOk || !within_ranges(q)) continue;
      ASSERT_GT((near.p - X.p).norm(), off - 1e-4);
    }
  }
}

TEST(Reach, FarOutOnALineThePlaceStaysOnIt) {
  const JointVector home = joints_deg(0, 0, 90, 0, 90, 0);
  const Pose A = forward(kArm, home);
  for (const Vec3& way : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0.6, 0.0, 0.8)}) {
    const TipSpace line = line_space(A.p, way);
    double last = 0.0;
    for (const double far : {0.5, 1.0, 2.0}) {
      const Reached r = reach(line, {A.p + far * way, A.q}, home);
      EXPECT_LT(line.distance(r.X.p), 1e-6);
      EXPECT_TRUE(within_ranges(r.q));
      const double travel = (r.X.p - A.p).dot(way);
      if (last > 0.0) {
        EXPECT_NEAR(travel, last, 1e-6);
      }
      last = travel;
    }
    EXPECT_LT(last, 0.5);
  }
}

TEST(Reach, WhereTheWristCannotTurnFurtherThePlaceIsKept) {
  const JointVector tilted = joints_deg(0, 35, 52, 0, 119, 0);
  const Pose A = forward(kArm, tilted);
  for (const double more : {0.05, 0.2, 0.4}) {
    const Pose X{A.p, A.q * rotation_exp(Vec3(0, more, 0))};
    const Reached r = reach({}, X, tilted);
    EXPECT_GE(r.joint, 0);
    EXPECT_FALSE(r.arm);
    EXPECT_TRUE(within_ranges(r.q));
    EXPECT_LT((r.X.p - A.p).norm(), 1e-7);
    EXPECT_LE(angle_between(r.X.q, X.q), more + 1e-9);
  }
}

// With J5 at its end near the base axis the tip can turn a long way in its place for little.
TEST(Reach, WhereTheWristIsAtItsEndItDoesNotMatterFromWhereTheTipComes) {
  const JointVector end = joints_deg(-41.0, -21.8, 51.7, -1.8, 119.9, -43.1);
  const Pose X{forward(kArm, end).p, forward(kArm, end + joints_deg(0, 0, 0, 0, 14, 0)).q};
  const Reached from_there = reach({}, X, end);
  ASSERT_GE(from_there.joint, 0);
  for (const Vec3& off : {Vec3(0.01, 0.01, 0), Vec3(-0.01, -0.01, 0), Vec3(0, 0.01, 0.01)}) {
    const Reached beside = reach({}, {X.p + off, X.q}, from_there.q);
    const Reached r = reach({}, X, beside.q);
    EXPECT_LT((r.q - from_there.q).cwiseAbs().maxCoeff(), 1e-3) << off.transpose();
  }
}

}  // namespace
}  // namespace handrail
