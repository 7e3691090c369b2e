#include "server/lab/stability/sampled_loop.h"

#include <gtest/gtest.h>

namespace handrail {
namespace {

TEST(SampledLoop, GrowthIsThatOfTheHalfPeriodByWhichAHeldSpringIsLate) {
  // Of m x'' + (b - K T / 2) x' + K x = 0.
  const SampledWall wall{.mass = 0.1, .damping = 0.1};
  EXPECT_NEAR(growth_rate(wall, 100.0), -(0.1 - 0.05) / 0.2, 0.005);
  EXPECT_NEAR(growth_rate(wall, 400.0), (0.2 - 0.1) / 0.2, 0.005);
}

TEST(SampledLoop, GrowthBeginsAtTheOnset) {
  for (const SampledWall& wall : {SampledWall{.mass = 0.1, .damping = 2.0},
                                  SampledWall{.mass = 0.1, .damping = 5.0, .delay = 2},
                                  SampledWall{.mass = 0.1, .damping = 0.1, .wall_damping = 20.0}}) {
    const double onset = stiffness_onset(wall);
    EXPECT_NEAR(measured_onset(wall, onset, 0.03), onset, 0.002 * onset);
  }
}

TEST(SampledLoop, AnOnsetThatIsNotNearIsNotFoundThere) {
  const SampledWall wall{.mass = 0.1, .damping = 2.0};
  const double onset = stiffness_onset(wall);
  EXPECT_EQ(measured_onset(wall, 2.0 * onset, 0.03), 0.97 * 2.0 * onset) << "begins before";
  EXPECT_EQ(measured_onset(wall, 0.5 * onset, 0.03), 1.03 * 0.5 * onset) << "begins behind";
}

TEST(SampledLoop, FrictionHidesAnInstabilityUpToASpeed) {
  const SampledWall wall{.mass = 0.045};
  const double formula = speed_that_grows(wall, 5000.0, 0.26).value();
  const double measured = measured_speed_that_grows(wall, 5000.0, 0.26, 2.0 * formula);
  EXPECT_GT(measured, formula);
  EXPECT_LT(measured, 1.11 * formula);
}

}  // namespace
}  // namespace handrail
