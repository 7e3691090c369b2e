#include "server/kinematics/arc_tangent.h"

#include <gtest/gtest.h>

#include <random>

namespace handrail {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(ArcTangent, AgreesWithTheLibraryAllTheWayRound) {
  std::mt19937_64 random(31);
  std::uniform_real_distribution<double> any(-kPi, kPi), decades(-12.0, 12.0);
  double worst = 0.0;
  for (int n = 0; n < 1'000'000; ++n) {
    const double angle = any(random), length = std::pow(10.0, decades(random));
    const double x = length * std::cos(angle), y = length * std::sin(angle);
    worst = std::max(worst, std::abs(arc_tangent(y, x) - std::atan2(y, x)));
  }
  EXPECT_LT(worst, 9e-16);
}

TEST(ArcTangent, KeepsRelativePrecisionNearZero) {
  for (double y = 1e-3; y > 1e-200; y *= 0.37) {
    EXPECT_NEAR(arc_tangent(y, 1.0) / std::atan2(y, 1.0), 1.0, 5e-16) << y;
    EXPECT_NEAR(arc_tangent(-y, 1.0) / std::atan2(-y, 1.0), 1.0, 5e-16) << y;
  }
}

TEST(ArcTangent, IsExactOnTheAxesAndDiagonals) {
  for (const double y : {-1.0, -0.0, 0.0, 1.0}) {
    for (const double x : {-1.0, 1.0}) {
      EXPECT_DOUBLE_EQ(arc_tangent(y, x), std::atan2(y, x)) << y << " " << x;
      EXPECT_EQ(std::signbit(arc_tangent(y, x)), std::signbit(y)) << y << " " << x;
    }
  }
  EXPECT_DOUBLE_EQ(arc_tangent(1.0, 0.0), 0.5 * kPi);
  EXPECT_DOUBLE_EQ(arc_tangent(-1.0, 0.0), -0.5 * kPi);
  EXPECT_EQ(arc_tangent(0.0, 0.0), 0.0);
}

TEST(ArcTangent, HasNoStepWhereItsFormulaChanges) {
  const double eighth = kPi / 8.0;
  for (int k = -8; k <= 8; ++k) {
    for (int i = -1000; i <= 1000; ++i) {
      const double angle = k * eighth + 1e-13 * i;
      const double y = std::sin(angle), x = std::cos(angle);
      EXPECT_NEAR(arc_tangent(y, x), std::atan2(y, x), 9e-16) << k << " " << i;
    }
  }
}

}  // namespace
}  // namespace handrail
