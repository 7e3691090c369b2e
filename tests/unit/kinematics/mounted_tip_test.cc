// A tip that is mounted aside of the flange's axis and turned, against KDL and against itself.
#include <gtest/gtest.h>

#include "server/base/random.h"
#include "server/kinematics/reach.h"
#include "tests/support/arm_samples.h"
#include "tests/support/kdl_arm.h"

namespace handrail {
namespace {

// Anywhere 0.3 m around the point A, turned anyhow.
Pose some_mount(Random& random) {
  Pose mount;
  for (int i = 0; i < 3; ++i) mount.p[i] = 0.6 * (random.uniform() - 0.5);
  const Vec3 turn(random.normal(), random.normal(), random.normal());
  mount.q = rotation_exp(turn);
  return mount;
}

// KDL has its own product of frames.
Pose by_kdl(test::KdlForward& to_a, const JointVector& q, const Pose& mount) {
  const auto frame = [](const Pose& X) {
    return KDL::Frame(KDL::Rotation::Quaternion(X.q.x(), X.q.y(), X.q.z(), X.q.w()),
                      KDL::Vector(X.p.x(), X.p.y(), X.p.z()));
  };
  const KDL::Frame tip = frame(to_a(q)) * frame(mount);
  Pose out;
  out.p = Vec3(tip.p.x(), tip.p.y(), tip.p.z());
  tip.M.GetQuaternion(out.q.x(), out.q.y(), out.q.z(), out.q.w());
  return out;
}

TEST(MountedTip, IsWhereKdlHasIt) {
  std::mt19937_64 joints(21);
  Random random(21);
  test::KdlForward to_a;
  for (int run = 0; run < 1000; ++run) {
    const JointVector q = test::random_joints(joints);
    ArmGeometry arm;
    arm.X_AT = some_mount(random);
    const Pose ours = forward(arm, q), theirs = by_kdl(to_a, q, *arm.X_AT);
    ASSERT_LT(test::position_error(ours, theirs), 1e-12);
    ASSERT_LT(test::rotation_error(ours, theirs), 1e-12);
  }
}

TEST(MountedTip, EachSolutionMapsBackAndTheNearOneIsTheSeed) {
  std::mt19937_64 joints(22);
  Random random(22);
  for (int run = 0; run < 1000; ++run) {
    const JointVector q = test::random_joints(joints);
    ArmGeometry arm;
    arm.X_AT = some_mount(random);
    const Pose X = forward(arm, q);
    InverseSolutions all;
    inverse_all(arm, X, q, all);
    ASSERT_GT(all.count, 0);
    for (int i = 0; i < all.count; ++i) {
      const Pose back = forward(arm, all.q[static_cast<std::size_t>(i)]);
      ASSERT_LT(test::position_error(back, X), 1e-9);
      ASSERT_LT(test::rotation_error(back, X), 1e-8);
    }
    if (near_singular(arm, q)) continue;
    JointVector near;
    ASSERT_EQ(inverse_near(arm, X, q, near), InverseStatus::kOk);
    ASSERT_LT((near - q).cwiseAbs().maxCoeff(), 1e-7);
  }
}

TEST(MountedTip, IsAsFarFromTheWristAndTheLastAxisAsItSays) {
  std::mt19937_64 joints(23);
  Random random(23);
  ArmGeometry to_wrist;
  to_wrist.d6 = 0.0;
  for (int run = 0; run < 200; ++run) {
    const JointVector q = test::random_joints(joints);
    ArmGeometry arm;
    arm.X_AT = some_mount(random);
    const Pose X = forward(arm, q), wrist = forward(to_wrist, q);
    ASSERT_LT((wrist.p + arm.wrist_to_tip(X.q) - X.p).norm(), 1e-12);
    ASSERT_NEAR((X.p - wrist.p).norm(), arm.tip_radius(), 1e-12);
    ASSERT_LT(angle_between(arm.turn_of_flange(X.q), wrist.q), 1e-7);
    const Vec3 axis = wrist.q * Vec3::UnitZ(), way = X.p - wrist.p;
    ASSERT_NEAR((way - way.dot(axis) * axis).norm(), arm.tip_aside(), 1e-12);
  }
}

// Where the joints end there, the place that is said is where the arm is.
TEST(MountedTip, OutOfReachThePlaceFoundIsWhereTheArmIsAndNoneNearIsNearer) {
  const ArmGeometry arm = test::bent_arm();
  const JointVector home = test::joints_deg(0, 0, 90, 0, 90, 0);
  const JointVector inside = JointVector::Constant(1e-4);
  const Pose A = forward(arm, home);
  Random random(24);
  for (const Vec3& way : {Vec3(1, 0, 0), Vec3(0.6, 0.6, 0.2), Vec3(0.3, -0.2, 0.9)}) {
    const Pose X{A.p + 1.2 * way, A.q};
    Reached r{home, A, -1, false};
    for (int k = 0; k < 400; ++k) {
      r = nearest_reachable(arm, rv2a_limits(), {}, X, r.q, inside);
    }
    EXPECT_TRUE(r.arm);
    EXPECT_LT((forward(arm, r.q).p - r.X.p).norm(), 1e-6);
    EXPECT_LT(angle_between(r.X.q, A.q), 1e-6);
    const double off = (r.X.p - X.p).norm();
    for (int run = 0; run < 2000; ++run) {
      const Vec3 aside(random.normal(), random.normal(), random.normal());
      JointVector q;
      const Pose near{r.X.p + 0.01 * aside, A.q};
      if (inverse_near(arm, near, r.q, q) != InverseStatus::kOk) continue;
      if ((q - rv2a_limits().lower).minCoeff() < 0 || (rv2a_limits().upper - q).minCoeff() < 0)
        continue;
      ASSERT_GT((near.p - X.p).norm(), off - 1e-4);
    }
  }
}

}  // namespace
}  // namespace handrail
