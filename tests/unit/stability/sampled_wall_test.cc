// The numbers of the tables were worked out from the same formulas by other programs, with Schur
// and Cohn's test and a search by halves.
#include "server/stability/sampled_wall.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <utility>
#include <vector>

namespace handrail {
namespace {

SampledWall small_mass(double damping, int delay, double wall_damping = 0.0) {
  return {.mass = 0.1, .damping = damping, .wall_damping = wall_damping, .delay = delay};
}

TEST(SampledWall, WithoutWallDampingItGetsUnstableWhereTheTableSays) {
  constexpr std::array kDamping = {0.05, 0.1, 0.5, 1.0, 2.0, 5.0};
  const std::map<int, std::array<double, 6>> onset = {
      {0, {100.0, 200.0, 1000.8, 2003.3, 4013.4, 10084.0}},
      {1, {33.3, 66.7, 333.8, 668.5, 1340.7, 3378.9}},
      {2, {20.0, 40.0, 200.4, 401.7, 806.9, 2042.2}},
      {10, {4.8, 9.5, 48.0, 96.9, 196.9, 513.5}},
      {50, {1.0, 2.0, 10.3, 21.3, 45.0, 124.5}}};
  for (const auto& [delay, row] : onset) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      // As many digits as are printed.
      const double printed = row[i] < 10'000.0 ? 0.05 : 0.5;
      EXPECT_NEAR(stiffness_onset(small_mass(kDamping[i], delay)), row[i], 1.02 * printed)
          << "b " << kDamping[i] << ", d " << delay;
    }
  }
}

TEST(SampledWall, WithWallDampingToo) {
  constexpr std::array kWall = {0.0, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0};
  const std::map<int, std::array<double, 8>> onset = {
      {0, {200.0, 1194, 2178, 4118, 9704, 18280, 32900, 60147}},
      {1, {66.7, 397.9, 725.4, 1369, 3211, 5982, 10379, 14017}},
      {10, {9.5, 56.1, 100.7, 183.6, 375.9, 439.9, 0, 0}}};
  for (const auto& [delay, row] : onset) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const double printed = row[i] < 1000.0 ? 0.05 : 0.5;
      EXPECT_NEAR(stiffness_onset(small_mass(0.1, delay, kWall[i])), row[i], 1.02 * printed)
          << "B " << kWall[i] << ", d " << delay;
    }
  }
}

// Without delay and wall damping the polynomial is of the second degree, and Jury's two conditions
// are all. From a device that hardly brakes to one that stands within a period.
TEST(SampledWall, HoweverMuchTheDeviceBrakesTheOnsetIsJurys) {
  for (const double x : {0.01, 0.3, 1.0, 3.0, 10.0, 30.0}) {  // b T / m
    const double e = std::exp(-x);
    const double h = (x - 1.0 + e) / (x * x), h_next = (1.0 - e - x * e) / (x * x);
    const double jury =
        std::min((1.0 - e) / h_next, h > h_next ? 2.0 * (1.0 + e) / (h - h_next) : 1e300);
    EXPECT_NEAR(stiffness_onset({.mass = 1.0, .damping = x, .period = 1.0}), jury, 1e-7 * jury)
        << x;
  }
}

// A mass of 1 and a period of 1: stiffness is K T^2 / m, damping B T / m.
TEST(SampledWall, AnUndampedDeviceHasTheEdgeOfTheClosedForm) {
  const auto edge = [](double beta, int delay) {
    return stiffness_onset({.mass = 1.0, .period = 1.0, .wall_damping = beta, .delay = delay});
  };
  for (const double beta : {0.1, 0.2, 0.4, 2.0 * std::sqrt(2.0) - 2.0, 1.5, 1.9}) {
    EXPECT_NEAR(edge(beta, 0), 2.0 * beta * (2.0 - beta) / (2.0 + beta), 1e-7) << beta;
  }
  EXPECT_NEAR(edge(2.0 * std::sqrt(2.0) - 2.0, 0), 12.0 - 8.0 * std::sqrt(2.0), 1e-7);
  EXPECT_NEAR(edge(0.1, 1), 0.05920, 5.1e-6);
  EXPECT_NEAR(edge(0.2, 1), 0.10321, 5.1e-6);
  EXPECT_NEAR(edge(0.4, 1), 0.14396, 5.1e-6);
  EXPECT_NEAR(edge(0.05, 5), 0.00795, 5.1e-6);
  EXPECT_NEAR(edge(0.1, 5), 0.01329, 5.1e-6);
  struct Best {
    int delay;
    double a, beta;
  };
  for (const Best& best :
       {Best{0, 0.68629, 0.82843}, Best{1, 0.14447, 0.42469}, Best{2, 0.06243, 0.29139},
        Best{3, 0.03478, 0.22238}, Best{5, 0.01535, 0.15115}, Best{10, 0.00455, 0.08405}}) {
    EXPECT_NEAR(edge(best.beta, best.delay), best.a, 5.1e-6) << "d " << best.delay;
    EXPECT_LT(edge(0.98 * best.beta, best.delay), best.a) << "d " << best.delay;
    EXPECT_LT(edge(1.02 * best.beta, best.delay), best.a) << "d " << best.delay;
    // The roots of (z - 1) z^(d+1) + beta (z + 1) / 2, what is left as the stiffness goes to zero.
    const double most = 2.0 * std::tan(M_PI / (4.0 * (best.delay + 1.0)));
    EXPECT_GT(edge(0.9999 * most, best.delay), 0.0) << "d " << best.delay;
    EXPECT_EQ(edge(1.0001 * most, best.delay), 0.0) << "d " << best.delay;
  }
  EXPECT_EQ(edge(0.0, 0), 0.0) << "nothing takes up what the wall makes";
}

SampledWall later(SampledWall wall, double late) {
  wall.late = late;
  return wall;
}

TEST(SampledWall, APartOfAPeriodLiesBetweenNoneAndAWhole) {
  for (const double damping : {0.1, 1.0, 5.0}) {
    const SampledWall wall = small_mass(damping, 1);
    double before = stiffness_onset(wall);
    EXPECT_NEAR(stiffness_onset(later(wall, 1e-9)), before, 1e-6 * before);
    for (const double late : {0.1, 0.35, 0.5, 0.9}) {
      const double here = stiffness_onset(later(wall, late));
      EXPECT_LT(here, before) << damping << ", " << late;
      before = here;
    }
    const double whole = stiffness_onset(small_mass(damping, 2));
    EXPECT_NEAR(stiffness_onset(later(wall, 1.0 - 1e-9)), whole, 1e-6 * whole);
  }
  EXPECT_EQ(passive_damping(later(small_mass(0.0, 1), 0.1), 1000.0),
            passive_damping(small_mass(0.0, 2), 1000.0));
}

// The plant by small steps, the loop as it is run: a kick grows above the onset and dies away
// below.
double swing_after(const SampledWall& wall, double stiffness, double seconds) {
  constexpr int kFiner = 100;
  const double h = wall.period / kFiner;
  double x = 0.0, v = 1.0, last = 0.0, most = 0.0;
  std::deque<double> forces(static_cast<std::size_t>(wall.delay) + 2, 0.0);
  const auto late = static_cast<int>(std::lround(wall.late * kFiner));
  const auto ticks = static_cast<int>(seconds / wall.period);
  for (int i = 0; i < ticks; ++i) {
    forces.push_back(-stiffness * x - wall.wall_damping * (x - last) / wall.period);
    forces.pop_front();
    last = x;
    for (int j = 0; j < kFiner; ++j) {
      const double force = forces[j < late ? 0 : 1];
      // Of the second order, and by no exponential.
      const double a = (force - wall.damping * v) / wall.mass;
      const double half = v + 0.5 * h * a;
      x += h * half;
      v += h * (force - wall.damping * half) / wall.mass;
    }
    if (i >= ticks / 2) most = std::max(most, std::abs(x));
  }
  return most;
}

TEST(SampledWall, AStepByStepSimulationGrowsAboveAndDiesAwayBelow) {
  for (const SampledWall& wall :
       {small_mass(0.1, 0), small_mass(5.0, 0), small_mass(1.0, 2), small_mass(2.0, 10),
        small_mass(0.1, 1, 5.0), small_mass(0.1, 10, 5.0), small_mass(0.1, 0, 50.0),
        later(small_mass(1.0, 0), 0.35), later(small_mass(0.1, 1, 5.0), 0.5),
        later(small_mass(5.0, 0), 0.9), later(small_mass(2.0, 10), 0.1)}) {
    const double onset = stiffness_onset(wall);
    const auto grows = [&](double stiffness) {
      return swing_after(wall, stiffness, 40.0) > swing_after(wall, stiffness, 20.0);
    };
    EXPECT_FALSE(grows(0.98 * onset)) << onset;
    EXPECT_TRUE(grows(1.02 * onset)) << onset;
  }
}

TEST(SampledWall, WhatADeviceTakesUpWhoeverHoldsItIsColgatesBound) {
  struct Row {
    double wall_damping;
    int delay;
    double least;
  };
  for (const Row& row : {Row{0, 0, 0.5}, Row{5, 0, 5.5}, Row{0, 1, 1.5}, Row{0.5, 1, 1.25},
                         Row{1, 1, 1.625}, Row{5, 1, 5.525}, Row{0, 5, 5.5}, Row{1, 5, 4.5},
                         Row{5, 5, 5.906}, Row{0, 10, 10.5}, Row{5, 10, 7.285}}) {
    const SampledWall wall{.mass = 0.1, .wall_damping = row.wall_damping, .delay = row.delay};
    EXPECT_NEAR(passive_damping(wall, 1000.0), row.least, 0.00051)
        << "B " << row.wall_damping << ", d " << row.delay;
  }
}

TEST(SampledWall, ASpringMakesInACycleWhatItsSamplesSay) {
  struct Row {
    double stiffness, amplitude, frequency, delay, millijoules;
  };
  for (const Row& row : {Row{1000, 5e-3, 1, 0, 0.24674}, Row{1000, 5e-3, 5, 0, 1.23360},
                         Row{1000, 5e-3, 5, 10e-3, 25.4394}, Row{800, 5e-3, 2, 7e-3, 5.91296},
                         Row{200, 20e-3, 1, 100e-3, 148.364}}) {
    const double made =
        1e3 * energy_per_cycle(row.stiffness, row.amplitude, row.frequency, 1e-3, row.delay);
    EXPECT_NEAR(made, row.millijoules, 6e-6 * row.millijoules + 5e-6);
    // Summed over a cycle: the force, held, times the way of each period.
    const auto ticks = static_cast<int>(std::lround(1e3 / row.frequency));
    const auto late = static_cast<int>(std::lround(row.delay * 1e3));
    const auto x = [&](int tick) {
      return row.amplitude * std::sin(2e-3 * M_PI * row.frequency * tick);
    };
    double sum = 0.0;
    for (int i = 0; i < ticks; ++i) sum -= row.stiffness * x(i - late) * (x(i + 1) - x(i));
    EXPECT_NEAR(made, 1e3 * sum, 1e-6 * row.millijoules);
  }
}

TEST(SampledWall, FrictionHidesWhatGrowsOnlyAboveASpeed) {
  struct Row {
    double mass, damping, friction, stiffness;
    int delay;
    double speed;
  };
  for (const Row& row : {Row{0.1, 0.1, 0.2, 1000, 0, 0.637}, Row{0.1, 0.1, 0.2, 2000, 0, 0.283},
                         Row{0.1, 0.1, 0.2, 500, 1, 0.392}, Row{0.1, 0.1, 0.2, 500, 5, 0.096},
                         Row{0.5, 0.5, 0.5, 1000, 2, 0.318}, Row{0.045, 0, 0.26, 800, 0, 0.828},
                         Row{0.045, 0, 0.26, 5000, 0, 0.132}}) {
    const SampledWall wall{.mass = row.mass, .damping = row.damping, .delay = row.delay};
    const auto speed = speed_that_grows(wall, row.stiffness, row.friction);
    ASSERT_TRUE(speed);
    EXPECT_NEAR(*speed, row.speed, 0.00051);
  }
  EXPECT_FALSE(speed_that_grows(small_mass(0.5, 0), 1000.0, 0.0)) << "just passive";
}

}  // namespace
}  // namespace handrail
