// Named singular poses: where joints are free, the seed decides.
#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/arm_samples.h"

namespace handrail {
namespace {

using test::joints_deg;
using test::turn_free_distance;

// J2 that puts the wrist centre on the J1 axis at J3 = 60 degrees, by bisection.
double j2_on_axis_deg() {
  double low = -45.0, high = 0.0;
  const auto radius = [](double j2) {
    return forward({.d6 = 0.0, .X_AT = {}}, joints_deg(0, j2, 60, 0, 0, 0)).p.x();
  };
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (radius(middle) < 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

bool contains(const InverseSolutions& found, const JointVector& q, double tolerance) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(found.count); ++i) {
    if (turn_free_distance(found.q[i], q) < tolerance) return true;
  }
  return false;
}

void expect_all_map_back(const Pose& X, const InverseSolutions& found) {
  EXPECT_GT(found.count, 0);
  for (std::size_t i = 0; i < static_cast<std::size_t>(found.count); ++i) {
    EXPECT_LT(test::position_error(forward({}, found.q[i]), X), 1e-9);
    EXPECT_LT(test::rotation_error(forward({}, found.q[i]), X), 1e-8);
  }
}

TEST(WristSingularity, KeepsTheSeedsJ4WhenJ5IsExactlyZero) {
  for (const double j4 : {-160.0, -90.0, -25.0, 0.0, 10.0, 90.0, 160.0}) {
    const JointVector seed = joints_deg(0, 0, 90, j4, 0, 90);
    const Pose X = forward({}, seed);
    JointVector q;
    ASSERT_EQ(inverse_near({}, X, seed, q), InverseStatus::kOk);
    EXPECT_LT((q - seed).cwiseAbs().maxCoeff(), 1e-14) << j4;
    EXPECT_EQ(q[3], seed[3]);
    InverseSolutions found;
    inverse_all({}, X, seed, found);
    EXPECT_TRUE(contains(found, seed, 1e-14)) << j4;
    expect_all_map_back(X, found);
  }
}

TEST(WristSingularity, KeepsTheSeedsJ4AndSignWhenComingFromEitherSide) {
  for (const double j5 : {-3.0, -1e-3, 1e-3, 3.0}) {
    const JointVector seed = joints_deg(10, 5, 95, 30, j5, 20);
    const JointVector straight = joints_deg(10, 5, 95, 30, 0, 20);
    JointVector q;
    ASSERT_EQ(inverse_near({}, forward({}, straight), seed, q), InverseStatus::kOk);
    EXPECT_EQ(q[3], seed[3]);
    EXPECT_LT((q - straight).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_EQ(std::signbit(q[4]), j5 < 0.0);
  }
}

TEST(WristSingularity, LeavesTowardTheSideThatKeepsJ4WhenTheSeedIsExactlyStraight) {
  const JointVector seed = joints_deg(0, 0, 90, -25, 0, 90);
  for (const double j5 : {-20.0, -5.0, -1.0, -1e-6, 1e-6, 1.0, 5.0, 20.0}) {
    const JointVector next = joints_deg(0, 0, 90, -25, j5, 90);
    JointVector q;
    ASSERT_EQ(inverse_near({}, forward({}, next), seed, q), InverseStatus::kOk);
    // J4 is as sharp as J5 is far from zero.
    EXPECT_LT((q - next).cwiseAbs().maxCoeff(), 1e-14 / std::abs(j5 * kDeg) + 1e-13) << j5;
  }
}

TEST(WristSingularity, IsPassedStraightThroughWithoutTurningJ4) {
  for (const double step_deg : {0.01, 0.3, 1.278}) {
    JointVector seed = joints_deg(0, 0, 90, 40, -4.0, 10);
    for (double j5 = -4.0; j5 < 4.0; j5 += step_deg) {
      const JointVector next = joints_deg(0, 0, 90, 40, j5, 10);
      JointVector q;
      ASSERT_EQ(inverse_near({}, forward({}, next), seed, q), InverseStatus::kOk);
      ASSERT_LT((q - next).cwiseAbs().maxCoeff(), 1e-8) << "J5 " << j5 << " step " << step_deg;
      seed = q;
    }
    EXPECT_GT(seed[4], 0.0);
  }
}

TEST(WristSingularity, StaysOnTheSeedsSideWhenJ5OnlyComesNear) {
  const JointVector seed = joints_deg(0, 0, 90, 40, -0.2, 10);
  const JointVector next = joints_deg(0, 0, 90, 70, -0.1, -20);
  JointVector q;
  ASSERT_EQ(inverse_near({}, forward({}, next), seed, q), InverseStatus::kOk);
  EXPECT_LT((q - next).cwiseAbs().maxCoeff(), 1e-11);
}

TEST(WristSingularity, KeepsTheSeedsJ4WhenTheWristIsFoldedBack) {
  const JointVector seed = joints_deg(20, 10, 80, 35, 180, -50);
  JointVector q;
  ASSERT_EQ(inverse_near({}, forward({}, seed), seed, q), InverseStatus::kOk);
  EXPECT_LT((q - seed).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(ShoulderSingularity, KeepsTheSeedsJ1WhenTheWristIsOnTheAxis) {
  const double j2 = j2_on_axis_deg();
  for (const double j1 : {-160.0, -90.0, 0.0, 45.0, 135.0}) {
    const JointVector seed = joints_deg(j1, j2, 60, 20, 50, -30);
    ASSERT_LT(singularity_margin({}, seed).shoulder, 1e-15);
    const Pose X = forward({}, seed);
    JointVector q;
    ASSERT_EQ(inverse_near({}, X, seed, q), InverseStatus::kOk);
    EXPECT_LT((q - seed).cwiseAbs().maxCoeff(), 1e-13) << j1;
    InverseSolutions found;
    inverse_all({}, X, seed, found);
    EXPECT_TRUE(contains(found, seed, 1e-13)) << j1;
    expect_all_map_back(X, found);
  }
}

TEST(ShoulderSingularity, IsPassedStraightThroughWithoutTurningJ1) {
  const double j2_axis = j2_on_axis_deg();
  JointVector seed = joints_deg(30, j2_axis + 2.0, 60, 20, 50, -30);
  for (double offset = 2.0; offset > -2.0; offset -= 0.37) {
    const JointVector next = joints_deg(30, j2_axis + offset, 60, 20, 50, -30);
    JointVector q;
    ASSERT_EQ(inverse_near({}, forward({}, next), seed, q), InverseStatus::kOk);
    ASSERT_LT((q - next).cwiseAbs().maxCoeff(), 1e-11) << "offset " << offset;
    seed = q;
  }
  EXPECT_TRUE(branch_of({}, seed).shoulder_back);
}

TEST(BothSingularities, KeepTheSeedsJ1AndJ4) {
  const JointVector seed = joints_deg(77, j2_on_axis_deg(), 60, -33, 0, 12);
  const Pose X = forward({}, seed);
  JointVector q;
  ASSERT_EQ(inverse_near({}, X, seed, q), InverseStatus::kOk);
  EXPECT_LT((q - seed).cwiseAbs().maxCoeff(), 1e-14);
  InverseSolutions found;
  inverse_all({}, X, seed, found);
  EXPECT_TRUE(contains(found, seed, 1e-14));
  expect_all_map_back(X, found);
}

TEST(ElbowSingularity, KeepsTheSeedWhenStretchedAndWhenFolded) {
  const double stretched_deg = std::atan2(0.130, 0.250) / kDeg;
  for (const double j3 : {stretched_deg, stretched_deg + 180.0}) {
    const JointVector seed = joints_deg(-40, 25, j3, 20, 50, -30);
    JointVector q;
    ASSERT_EQ(inverse_near({}, forward({}, seed), seed, q), InverseStatus::kOk);
    EXPECT_LT((q - seed).cwiseAbs().maxCoeff(), 1e-6);  // square root of rounding
  }
}

}  // namespace
}  // namespace handrail
