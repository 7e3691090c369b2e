#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/arm_samples.h"

namespace handrail {
namespace {

using test::joints_deg;

// R = Rz(C) Ry(B) Rx(A), the controller's convention.
Quat from_abc_deg(double a, double b, double c) {
  return Eigen::AngleAxisd(c * kDeg, Vec3::UnitZ()) * Eigen::AngleAxisd(b * kDeg, Vec3::UnitY()) *
         Eigen::AngleAxisd(a * kDeg, Vec3::UnitX());
}

struct CheckPose {
  JointVector q;
  Vec3 p_mm;
  Vec3 abc_deg;
};

TEST(Forward, GivesTheCheckPosesOfTheFlange) {
  const ArmGeometry flange{.d6 = kFlangeLength, .X_AT = {}};
  const CheckPose poses[] = {
      {joints_deg(0, 0, 90, 0, 0, 0), {435, 0, 730}, {0, 90, 0}},
      {joints_deg(0, 0, 90, 0, 90, 0), {350, 0, 645}, {180, 0, 180}},
      {joints_deg(0, 20, 110, 0, 50, 0), {460.579, 0, 438.812}, {180, 0, 180}},
      {joints_deg(30, 10, 120, 20, 0, 90),
       {418.809, 241.800, 480.454},
       {131.763, -15.189, 106.832}},
      {joints_deg(45, -20, 100, 30, 60, -40),
       {179.776, 231.827, 700.959},
       {179.435, 49.322, -100.929}}};
  for (const CheckPose& pose : poses) {
    const Pose X_ST = forward(flange, pose.q);
    EXPECT_LT((X_ST.p / kMm - pose.p_mm).cwiseAbs().maxCoeff(), 6e-4) << pose.q.transpose() / kDeg;
    const Quat expected = from_abc_deg(pose.abc_deg.x(), pose.abc_deg.y(), pose.abc_deg.z());
    EXPECT_LT(angle_between(X_ST.q, expected) / kDeg, 1.5e-3) << pose.q.transpose() / kDeg;
  }
}

TEST(Forward, PutsTheHexKeyBeyondTheFlangeOnTheToolAxis) {
  const JointVector q = joints_deg(45, -20, 100, 30, 60, -40);
  const Pose flange = forward({.d6 = kFlangeLength, .X_AT = {}}, q);
  const Pose key = forward({}, q);
  const Vec3 in_flange = inverse(flange).q * (key.p - flange.p);
  EXPECT_LT((in_flange - Vec3(0, 0, kHexKeyLength - kFlangeLength)).norm(), 1e-15);
  EXPECT_LT(test::rotation_error(flange, key), 1e-15);
}

TEST(Forward, ReachesTheCatalogueRadiusAtTheElbowsLimit) {
  const ArmGeometry wrist{.d6 = 0.0, .X_AT = {}};
  double best = 0.0;
  int best_j2 = 0;
  for (int j2 = -45; j2 <= 135; ++j2) {
    const Pose X = forward(wrist, joints_deg(0, j2, 50, 0, 0, 0));
    if (X.p.x() > best) {
      best = X.p.x();
      best_j2 = j2;
    }
  }
  EXPECT_EQ(best_j2, 78);
  EXPECT_NEAR(best / kMm, 621.58, 0.005);
}

TEST(Forward, GivesAUnitQuaternionAlsoAfterManyTurns) {
  const JointVector q = joints_deg(370, 400, -700, 1000, 725, 5000);
  const Pose X = forward({}, q);
  EXPECT_NEAR(X.q.norm(), 1.0, 1e-15);
  const Pose same = forward({}, joints_deg(10, 40, 20, -80, 5, -40));
  EXPECT_LT(test::position_error(X, same), 1e-13);
  EXPECT_LT(test::rotation_error(X, same), 1e-13);
}

TEST(Limits, AreTheTableWithJ2InTheControllersAngle) {
  const JointLimits& l = rv2a_limits();
  const JointVector lower = joints_deg(-160, -45, 50, -160, -120, -200);
  const JointVector upper = joints_deg(160, 135, 170, 160, 120, 200);
  const JointVector speed = joints_deg(150, 150, 180, 240, 180, 330);
  EXPECT_LT((l.lower - lower).norm(), 1e-15);
  EXPECT_LT((l.upper - upper).norm(), 1e-15);
  EXPECT_LT((l.max_speed - speed).norm(), 1e-15);
  EXPECT_LT((l.max_acceleration * 0.15 - speed).norm(), 1e-14);
}

TEST(BranchOf, NamesTheHomePoseAsFrontUpAndNotFlipped) {
  EXPECT_EQ(branch_of({}, joints_deg(0, 0, 90, -25, 0, 90)), Branch{});
  EXPECT_EQ(branch_of({}, joints_deg(0, 0, 90, -25, 30, 90)), Branch{});
}

TEST(BranchOf, NamesEachConfigurationApart) {
  EXPECT_TRUE(branch_of({}, joints_deg(0, -45, 50, 0, 10, 0)).shoulder_back);
  EXPECT_TRUE(branch_of({}, joints_deg(0, 0, 27, 0, 10, 0)).elbow_down);
  EXPECT_FALSE(branch_of({}, joints_deg(0, 0, 28, 0, 10, 0)).elbow_down);
  EXPECT_TRUE(branch_of({}, joints_deg(0, 0, 90, 0, -10, 0)).wrist_flipped);
}

TEST(BranchOf, IgnoresWholeTurns) {
  EXPECT_EQ(branch_of({}, joints_deg(360, 360, 450, 0, 350, 0)),
            branch_of({}, joints_deg(0, 0, 90, 0, -10, 0)));
  EXPECT_EQ(branch_of({}, joints_deg(0, -360, -270, 0, -350, 0)),
            branch_of({}, joints_deg(0, 0, 90, 0, 10, 0)));
}

TEST(SingularityMargin, IsZeroAtEachSingularPoseAndOneWhereTheWristIsSquare) {
  const double stretched_deg = std::atan2(0.130, 0.250) / kDeg;
  EXPECT_LT(singularity_margin({}, joints_deg(0, 0, 90, 0, 0, 0)).wrist, 1e-15);
  EXPECT_NEAR(singularity_margin({}, joints_deg(0, 0, 90, 0, -90, 0)).wrist, 1.0, 1e-15);
  EXPECT_LT(singularity_margin({}, joints_deg(0, 30, stretched_deg, 0, 0, 0)).elbow, 1e-15);
  EXPECT_NEAR(singularity_margin({}, joints_deg(0, 30, stretched_deg + 90, 0, 0, 0)).elbow, 1.0,
              1e-15);
}

TEST(SingularityMargin, MeasuresTheShoulderInMetresFromTheAxis) {
  const ArmGeometry wrist{.d6 = 0.0, .X_AT = {}};
  for (const double j2 : {-45.0, -10.0, 20.0, 90.0}) {
    const JointVector q = joints_deg(33, j2, 60, 0, 0, 0);
    const Vec3 p = forward(wrist, q).p;
    EXPECT_NEAR(singularity_margin({}, q).shoulder, std::hypot(p.x(), p.y()), 1e-15) << j2;
  }
}

}  // namespace
}  // namespace handrail
