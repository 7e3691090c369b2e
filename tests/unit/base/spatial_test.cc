#include "server/base/spatial.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <random>

namespace handrail {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Vec3 random_unit(std::mt19937_64& random) {
  std::normal_distribution<double> n;
  return Vec3(n(random), n(random), n(random)).normalized();
}

TEST(RotationExp, IsTheIdentityAtZero) {
  const Quat q = rotation_exp(Vec3::Zero());
  EXPECT_EQ(q.coeffs(), Quat::Identity().coeffs());
}

TEST(RotationExp, AgreesWithTheAngleAxisForm) {
  std::mt19937_64 random(11);
  for (const double angle :
       {1e-8, 1e-7, 0.9e-6, 1.1e-6, 1e-3, 1.0, kPi - 1e-9, kPi, 4.0, 2 * kPi}) {
    const Vec3 axis = random_unit(random);
    const Quat q = rotation_exp(angle * axis);
    const Quat reference(Eigen::AngleAxisd(angle, axis));
    EXPECT_LT((q.coeffs() - reference.coeffs()).norm(), 1e-15) << angle;
    EXPECT_NEAR(q.norm(), 1.0, 1e-15) << angle;
  }
}

TEST(RotationLog, UndoesExpFromZeroToHalfATurn) {
  std::mt19937_64 random(12);
  for (const double angle : {0.0, 1e-12, 1e-9, 1e-8, 1e-6, 1e-3, 1.0, 3.0, kPi - 1e-8}) {
    const Vec3 v = angle * random_unit(random);
    EXPECT_LT((rotation_log(rotation_exp(v)) - v).norm(), 1e-15 + 4e-16 * angle) << angle;
  }
}

TEST(RotationLog, KeepsRelativePrecisionForTinyRotations) {
  const Vec3 v(3e-9, -4e-9, 12e-9);
  EXPECT_LT((rotation_log(rotation_exp(v)) - v).norm(), 1e-15 * v.norm());
}

TEST(RotationLog, IsTheSameForBothSignsOfTheQuaternion) {
  std::mt19937_64 random(13);
  for (const double angle : {0.0, 1e-10, 1e-8, 0.5, 3.0}) {
    const Quat q = rotation_exp(angle * random_unit(random));
    const Quat minus(-q.w(), -q.x(), -q.y(), -q.z());
    EXPECT_LT((rotation_log(q) - rotation_log(minus)).norm(), 1e-15) << angle;
  }
}

TEST(RotationLog, TakesTheShorterWayRound) {
  const Vec3 axis = Vec3(1, 2, -2) / 3.0;
  EXPECT_LT((rotation_log(rotation_exp(4.0 * axis)) - (4.0 - 2 * kPi) * axis).norm(), 1e-15);
}

TEST(RotationLog, KeepsTheAxisOfTheVectorPartAtHalfATurn) {
  EXPECT_LT((rotation_log(Quat(0, 0, 1, 0)) - Vec3(0, kPi, 0)).norm(), 1e-15);
  EXPECT_LT((rotation_log(Quat(0, 0, -1, 0)) - Vec3(0, -kPi, 0)).norm(), 1e-15);
}

TEST(SmallestTurn, IsThatOfEigen) {
  std::mt19937_64 random(20);
  for (int i = 0; i < 200; ++i) {
    const Vec3 from = 3.0 * random_unit(random);
    Vec3 to = random_unit(random);
    if (i % 4 == 0) to = std::pow(10.0, -0.04 * i) * to - 2.0 * from;
    const Quat q = smallest_turn(from, to);
    EXPECT_TRUE(is_unit(q, 1e-12));
    // The axis is as well known as the rounding of the two lets it be.
    const double known = 3e-16 / from.normalized().cross(to.normalized()).norm();
    EXPECT_LT((q * from.normalized() - to.normalized()).norm(), 1e-12 + known) << i;
    if (i % 4 == 0) continue;
    EXPECT_LT(angle_between(q, Quat::FromTwoVectors(from, to)), 1e-9) << i;
  }
}

TEST(SmallestTurn, OfOppositeDirectionsIsAHalfTurn) {
  for (const Vec3& from : {Vec3(0.0, 0.0, 2.0), Vec3(-1.0, 0.0, 0.0), Vec3(0.8, -0.1, 0.6)}) {
    const Quat q = smallest_turn(from, -3.0 * from);
    EXPECT_TRUE(is_unit(q, 1e-12));
    EXPECT_LT((q * from + from).norm(), 1e-12);
  }
  EXPECT_LT((smallest_turn(Vec3::UnitZ(), -Vec3::UnitZ()) * Vec3::UnitX() - Vec3::UnitX()).norm(),
            1e-12);
  EXPECT_EQ(angle_between(smallest_turn(Vec3::UnitY(), 5.0 * Vec3::UnitY()), Quat::Identity()),
            0.0);
}

TEST(AngleBetween, IsSymmetricAndBlindToSigns) {
  const Quat a = rotation_exp(Vec3(0.1, 0.2, 0.3)), b = rotation_exp(Vec3(-1.0, 0.5, 2.0));
  const Quat minus_b(-b.w(), -b.x(), -b.y(), -b.z());
  EXPECT_NEAR(angle_between(a, b), angle_between(b, a), 1e-15);
  EXPECT_NEAR(angle_between(a, b), angle_between(a, minus_b), 1e-15);
  EXPECT_EQ(angle_between(a, a), 0.0);
  EXPECT_NEAR(angle_between(a, a * rotation_exp(Vec3(0, 1e-8, 0))), 1e-8, 1e-16);
}

TEST(Pose, ComposesAndInvertsLikeAMatrix) {
  std::mt19937_64 random(14);
  const Pose X_AB{Vec3(1, 2, 3), rotation_exp(random_unit(random))};
  const Pose X_BC{Vec3(-2, 0.5, 4), rotation_exp(2.5 * random_unit(random))};
  const Vec3 p_C(0.3, -0.7, 0.2);
  const Vec3 p_B = X_BC.q * p_C + X_BC.p;
  const Vec3 p_A = X_AB.q * p_B + X_AB.p;
  const Pose X_AC = X_AB * X_BC;
  EXPECT_LT((X_AC.q * p_C + X_AC.p - p_A).norm(), 1e-14);
  const Pose X_CA = inverse(X_AC);
  EXPECT_LT((X_CA.q * p_A + X_CA.p - p_C).norm(), 1e-14);
}

TEST(IsFinite, SeesEveryElement) {
  EXPECT_TRUE(is_finite(Pose{}));
  EXPECT_TRUE(is_finite(Wrench{}));
  for (int i = 0; i < 3; ++i) {
    Pose x;
    x.p[i] = std::numeric_limits<double>::infinity();
    EXPECT_FALSE(is_finite(x)) << i;
    Wrench force, torque;
    force.force[i] = kNan;
    torque.torque[i] = kNan;
    EXPECT_FALSE(is_finite(force)) << i;
    EXPECT_FALSE(is_finite(torque)) << i;
  }
  for (int i = 0; i < 4; ++i) {
    Pose x;
    x.q.coeffs()[i] = kNan;
    EXPECT_FALSE(is_finite(x)) << i;
  }
}

TEST(IsUnit, AcceptsRoundingAndNothingElse) {
  EXPECT_TRUE(is_unit(Quat::Identity()));
  EXPECT_TRUE(is_unit(Quat(1.0 + 1e-8, 0, 0, 0)));
  EXPECT_FALSE(is_unit(Quat(1.001, 0, 0, 0)));
  EXPECT_FALSE(is_unit(Quat(0, 0, 0, 0)));
  EXPECT_FALSE(is_unit(Quat(kNan, 0, 0, 0)));
}

}  // namespace
}  // namespace handrail
