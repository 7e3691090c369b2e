#include "devices/hand/hand_wander.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace handrail {
namespace {

constexpr double kWanderTick = 1e-3;

constexpr double kCoarse = 10e-3;

// Power of one axis of a track sampled every kCoarse, at `hertz`, by direct correlation.
double power_at(const std::vector<Vec3>& track, int axis, double hertz) {
  const auto turn = std::polar(1.0, -2.0 * std::numbers::pi * hertz * kCoarse);
  std::complex<double> phasor = 1.0;
  std::complex<double> sum = 0.0;
  for (const Vec3& p : track) {
    sum += p[axis] * phasor;
    phasor *= turn;
  }
  return std::norm(sum);
}

TEST(HandWander, TremorHasTheGivenRmsAndItsPowerFromEightToTwelveHertz) {
  for (const std::uint64_t seed : {1u, 2u, 77u}) {
    HandWander wander(seed, 0.05e-3, 0.0, 0.0);
    std::vector<Vec3> track;
    double sum = 0.0;
    for (int i = 0; i < 6000; ++i) {
      wander.step(kCoarse);
      track.push_back(wander.position());
      sum += track.back().squaredNorm();
    }
    EXPECT_NEAR(std::sqrt(sum / 6000.0), 0.05e-3, 0.005e-3) << seed;
    for (int axis = 0; axis < 3; ++axis) {
      double peak = 0.0;
      double peak_at = 0.0;
      double inside = 0.0;
      double all = 0.0;
      for (int bin = 1; bin < 40 * 60; ++bin) {
        const double hertz = bin / 60.0;
        const double power = power_at(track, axis, hertz);
        all += power;
        if (hertz >= 8.0 && hertz <= 12.0) inside += power;
        if (power > peak) {
          peak = power;
          peak_at = hertz;
        }
      }
      EXPECT_GE(peak_at, 8.0) << seed;
      EXPECT_LE(peak_at, 12.0) << seed;
      EXPECT_GT(inside, 0.95 * all) << seed;
    }
  }
}

TEST(HandWander, DriftSettlesToTheGivenRms) {
  HandWander wander(5, 0.0, 0.97e-3, 0.0122);
  double position = 0.0;
  double rotation = 0.0;
  constexpr int kSteps = 600'000;
  for (int i = 0; i < kSteps; ++i) {
    wander.step(5e-3);
    position += wander.position().squaredNorm();
    rotation += wander.rotation().squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(position / kSteps), 0.97e-3, 0.04 * 0.97e-3);
  EXPECT_NEAR(std::sqrt(rotation / kSteps), 0.0122, 0.04 * 0.0122);
}

// Root mean square of the position over the next `steps` steps of a millisecond.
double rms_ahead(HandWander& wander, int steps) {
  double sum = 0.0;
  for (int i = 0; i < steps; ++i) {
    wander.step(kWanderTick);
    sum += wander.position().squaredNorm();
  }
  return std::sqrt(sum / steps);
}

TEST(HandWander, TremorKeepsItsSizeAndItsPaceOverTenMinutes) {
  HandWander fine(4, 0.05e-3, 0.0, 0.0);
  HandWander coarse(4, 0.05e-3, 0.0, 0.0);
  EXPECT_NEAR(rms_ahead(fine, 60'000), 0.05e-3, 0.001e-3);
  for (int i = 0; i < 480'000; ++i) fine.step(kWanderTick);
  EXPECT_NEAR(rms_ahead(fine, 60'000), 0.05e-3, 0.001e-3);
  for (int i = 0; i < 60'000; ++i) coarse.step(10.0 * kWanderTick);
  EXPECT_LT((fine.position() - coarse.position()).norm(), 1e-12);
}

// Two first-order lags on white noise: (S e^(-t/S) - F e^(-t/F)) / (S - F), S = 3 s and F = 0.6 s.
TEST(HandWander, DriftForgetsWhereItWasAtThePaceOfItsLags) {
  for (const double dt : {1e-3, kCoarse}) {
    HandWander wander(6, 0.0, 1e-3, 0.01);
    const int steps = static_cast<int>(6000.0 / kCoarse);
    const int per_sample = static_cast<int>(kCoarse / dt + 0.5);
    std::vector<Vec3> track;
    std::vector<Vec3> turns;
    for (int i = 0; i < steps; ++i) {
      for (int k = 0; k < per_sample; ++k) wander.step(dt);
      track.push_back(wander.position() / 1e-3);
      turns.push_back(wander.rotation() / 0.01);
    }
    for (const double lag : {0.0, 0.5, 1.0, 3.0}) {
      const auto shift = static_cast<std::size_t>(lag / kCoarse + 0.5);
      double product = 0.0;
      double turn_product = 0.0;
      double crossed = 0.0;
      for (std::size_t i = shift; i < track.size(); ++i) {
        product += track[i].dot(track[i - shift]);
        turn_product += turns[i].dot(turns[i - shift]);
        crossed += track[i].dot(turns[i - shift]);
      }
      const auto count = static_cast<double>(track.size() - shift);
      const double expected = (3.0 * std::exp(-lag / 3.0) - 0.6 * std::exp(-lag / 0.6)) / 2.4;
      // Three standard deviations: some 6000 / 3.6 independent values on each of three axes.
      EXPECT_NEAR(product / count, expected, 0.06) << lag << " s, steps of " << dt;
      EXPECT_NEAR(turn_product / count, expected, 0.06) << lag << " s, steps of " << dt;
      EXPECT_NEAR(crossed / count, 0.0, 0.06) << lag << " s, steps of " << dt;
    }
  }
}

TEST(HandWander, AnySplitOfTheTimeGivesTheSameMotion) {
  HandWander whole(8, 0.05e-3, 0.97e-3, 0.0122);
  HandWander split(8, 0.05e-3, 0.97e-3, 0.0122);
  for (int i = 0; i < 1000; ++i) {
    whole.step(10e-3);
    for (const double dt : {0.3e-3, 0.7e-3, 4e-3, 0.25e-3, 0.75e-3, 3e-3, 1e-3}) split.step(dt);
    ASSERT_LT((whole.position() - split.position()).norm(), 1e-13) << i;
    ASSERT_LT((whole.velocity() - split.velocity()).norm(), 1e-11) << i;
    ASSERT_LT((whole.rotation() - split.rotation()).norm(), 1e-11) << i;
  }
  EXPECT_GT(whole.position().norm(), 1e-5);
}

TEST(HandWander, TheTurningDriftLeavesThePathOfTheTipAlone) {
  HandWander turning(8, 0.05e-3, 0.97e-3, 0.0122);
  HandWander straight(8, 0.05e-3, 0.97e-3, 0.0);
  for (int i = 0; i < 1000; ++i) {
    turning.step(kWanderTick);
    straight.step(kWanderTick);
    ASSERT_EQ(turning.position(), straight.position()) << i;
  }
}

TEST(HandWander, VelocityIsTheRateOfThePositionAndHasNoJumps) {
  HandWander wander(3, 0.05e-3, 0.97e-3, 0.0);
  Vec3 last = wander.position();
  Vec3 last_v = wander.velocity();
  for (int i = 0; i < 20'000; ++i) {
    wander.step(kWanderTick);
    const Vec3 rate = (wander.position() - last) / kWanderTick;
    EXPECT_LT((rate - 0.5 * (wander.velocity() + last_v)).norm(), 0.2e-3) << i;
    EXPECT_LT((wander.velocity() - last_v).norm(), 1.5e-3) << i;
    last = wander.position();
    last_v = wander.velocity();
  }
}

TEST(HandWander, TremorPivotsTheStylus) {
  HandWander wander(3, 0.05e-3, 0.0, 0.0);
  wander.step(kWanderTick);
  const Vec3 p = wander.position();
  const Vec3 moved = wander.rotation().cross(Vec3(0.0, 0.0, 0.05));
  EXPECT_NEAR(moved.x(), p.x(), 1e-15);
  EXPECT_NEAR(moved.y(), p.y(), 1e-15);
}

TEST(HandWander, AStillHandIsExactlyStill) {
  HandWander wander(9, 0.0, 0.0, 0.0);
  for (int i = 0; i < 100; ++i) wander.step(kWanderTick);
  EXPECT_EQ(wander.position(), Vec3::Zero());
  EXPECT_EQ(wander.rotation(), Vec3::Zero());
}

TEST(HandWander, OtherSeedsGiveOtherMotion) {
  HandWander a(1, 0.05e-3, 0.97e-3, 0.0);
  HandWander b(2, 0.05e-3, 0.97e-3, 0.0);
  a.step(kWanderTick);
  b.step(kWanderTick);
  EXPECT_NE(a.position(), b.position());
}

}  // namespace
}  // namespace handrail
