#include "server/haptic/smoother.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <deque>
#include <memory>
#include <numbers>
#include <vector>

#include "tests/unit/constraint/tool_samples.h"

namespace handrail {
namespace {

using test::Dice;
using Scalar = Eigen::Matrix<double, 1, 1>;

constexpr int kPublishedLength = 200;
constexpr int kLowLagLength = 105;

Scalar scalar(double v) { return Scalar(v); }

// Lag behind a ramp of one unit a sample, once the window is full.
double lag_on_ramp(int length) {
  RunningMean<1> mean;
  mean.reset(scalar(0.0), length);
  double out = 0.0;
  for (int i = 1; i <= 5 * length; ++i) out = mean.push(scalar(i))[0];
  return 5.0 * length - out;
}

// Greatest gain for sines of 8 to 12 Hz, where tremor lives, from the response to an impulse.
double worst_tremor_gain(int length) {
  RunningMean<1> mean;
  mean.reset(scalar(0.0), length);
  std::vector<double> response{mean.push(scalar(1.0))[0]};
  for (int i = 0; i < 2 * length; ++i) response.push_back(mean.push(scalar(0.0))[0]);
  double worst = 0.0;
  for (double hz = 8.0; hz <= 12.0; hz += 0.01) {
    std::complex<double> gain = 0.0;
    for (std::size_t k = 0; k < response.size(); ++k) {
      gain += response[k] *
              std::polar(1.0, -2.0 * std::numbers::pi * hz * 1e-3 * static_cast<double>(k));
    }
    worst = std::max(worst, std::abs(gain));
  }
  return worst;
}

TEST(RunningMean, LagsARampByHalfTheWindow) {
  EXPECT_NEAR(lag_on_ramp(kPublishedLength), 99.5, 1e-9);
  EXPECT_NEAR(lag_on_ramp(kLowLagLength), 52.0, 1e-9);
  EXPECT_NEAR(lag_on_ramp(1), 0.0, 1e-12);
}

TEST(RunningMean, TheShorterWindowRejectsTremorAtLeastAsWellAsThePublishedOne) {
  EXPECT_LE(worst_tremor_gain(kLowLagLength), worst_tremor_gain(kPublishedLength));
  EXPECT_LT(worst_tremor_gain(kPublishedLength), 0.25);
}

TEST(RunningMean, TheMeanOfAConstantIsExact) {
  Dice dice(31);
  for (const int length : {1, 3, 105, 200, kMaxSmootherLength}) {
    RunningMean<3> mean;
    const Vec3 start = dice.within(1.0), constant = dice.within(1.0);
    mean.reset(start, length);
    // Since the restart, so that a still hand commands exactly its pose ...
    for (int i = 0; i < 3 * length; ++i) ASSERT_EQ(mean.push(start), start);
    // ... and after a move, so that the command of a hand that came to rest is at rest.
    for (int i = 0; i < length; ++i) mean.push(constant);
    for (int i = 0; i < 3 * length; ++i) ASSERT_EQ(mean.push(constant), constant);
  }
}

TEST(RunningMean, TheFirstSamplesCountAsIfTheHandHadStoodThereBefore) {
  RunningMean<1> mean;
  mean.reset(scalar(7.0), kPublishedLength);
  for (int i = 1; i <= kPublishedLength; ++i) {
    EXPECT_NEAR(mean.push(scalar(8.0))[0], 7.0 + i / 200.0, 1e-14);
  }
}

TEST(RunningMean, ARestartForgetsTheSamplesBefore) {
  RunningMean<1> mean;
  mean.reset(scalar(0.0), 10);
  for (int i = 0; i < 37; ++i) mean.push(scalar(1e6 * i));
  mean.reset(scalar(-3.0), 5);
  EXPECT_EQ(mean.push(scalar(-3.0))[0], -3.0);
  EXPECT_EQ(mean.push(scalar(2.0))[0], -2.0);
}

TEST(RunningMean, AgreesWithTheSumOfTheLastSamples) {
  Dice dice(32);
  RunningMean<3> mean;
  const Vec3 start = dice.within(0.5);
  mean.reset(start, kPublishedLength);
  std::deque<Vec3> window(kPublishedLength, start);
  for (int i = 0; i < 5000; ++i) {
    window.push_back(dice.within(0.5));
    window.pop_front();
    Vec3 sum = Vec3::Zero();
    for (const Vec3& v : window) sum += v;
    ASSERT_LT((mean.push(window.back()) - sum / kPublishedLength).norm(), 1e-14);
  }
}

// A running sum that is only ever added to and taken from keeps every rounding error: at 1 kHz for
// days it drifts. Values of many sizes make each step round as badly as it can.
TEST(RunningMean, DoesNotDriftOverMillionsOfAdversarialSamples) {
  Dice dice(33);
  RunningMean<1> mean;
  mean.reset(scalar(0.0), kPublishedLength);
  std::vector<double> window(kPublishedLength, 0.0);
  const auto push = [&](int i, double value) {
    window[static_cast<std::size_t>(i % kPublishedLength)] = value;
    return mean.push(scalar(value))[0];
  };
  constexpr int kSamples = 10'000'000;
  for (int i = 0; i < kSamples; ++i) {
    // Thirds and tenths do not end in binary; now and then one 10^6 times as large rounds the rest.
    push(i, (i % 1001 == 0 ? 1e6 : 1.0) * ((i % 7) / 3.0 - (i % 11) / 10.0));
  }
  double out = 0.0;
  for (int i = kSamples; i < kSamples + 2 * kPublishedLength; ++i) {
    out = push(i, dice.between(-1.0, 1.0));
  }
  long double exact = 0.0L;
  for (const double v : window) exact += v;
  EXPECT_NEAR(out, static_cast<double>(exact / kPublishedLength), 1e-15);
}

TEST(RunningMean, MonotoneInputGivesMonotoneOutput) {
  Dice dice(34);
  RunningMean<1> mean;
  double value = 0.3, last = 0.3;
  mean.reset(scalar(value), kPublishedLength);
  for (int i = 0; i < 20000; ++i) {
    if (dice.between(0.0, 1.0) < 0.3) value += dice.between(0.0, 1e-3);
    const double out = mean.push(scalar(value))[0];
    // Up to rounding: a ten-thousandth of a nanometre for positions.
    ASSERT_GE(out, last - 1e-13);
    ASSERT_LE(out, value + 1e-13);
    last = out;
  }
}

TEST(OrientationSmoother, TheSignOfAQuaternionMakesNoJump) {
  Dice dice(35);
  auto plain = std::make_unique<OrientationSmoother>();
  auto alternating = std::make_unique<OrientationSmoother>();
  Quat q = dice.turn(3.0);
  plain->reset(q, kPublishedLength);
  alternating->reset(Quat(Eigen::Vector4d(-q.coeffs())), kPublishedLength);
  Quat last = q;
  for (int i = 0; i < 3000; ++i) {
    q = (rotation_exp(dice.within(2e-3)) * q).normalized();
    const Quat a = plain->push(q);
    const Quat b = alternating->push(i % 2 == 0 ? q : Quat(Eigen::Vector4d(-q.coeffs())));
    ASSERT_LT(angle_between(a, b), 1e-12);
    ASSERT_LT(angle_between(a, last), 4e-3);
    last = a;
  }
}

TEST(OrientationSmoother, LagsASteadyTurnByHalfTheWindow) {
  auto smoother = std::make_unique<OrientationSmoother>();
  constexpr double kStep = 1e-3;
  const Vec3 axis = Vec3(1, 2, 3).normalized();
  smoother->reset(Quat::Identity(), kPublishedLength);
  Quat out;
  for (int i = 1; i <= 10000; ++i) out = smoother->push(rotation_exp(i * kStep * axis));
  EXPECT_LT(angle_between(out, rotation_exp((10000 - 99.5) * kStep * axis)), 1e-9);
  EXPECT_TRUE(is_unit(out, 1e-14));
}

TEST(OrientationSmoother, StaysFiniteWhenTheSamplesHaveNoMean) {
  auto smoother = std::make_unique<OrientationSmoother>();
  smoother->reset(Quat::Identity(), 12);
  // Twelve turns by a sixth go once round the quaternion sphere and add up to nothing.
  for (int i = 0; i < 30; ++i) {
    const Quat newest = rotation_exp({i * std::numbers::pi / 3.0, 0, 0});
    const Quat out = smoother->push(newest);
    ASSERT_TRUE(is_finite(out));
    ASSERT_TRUE(is_unit(out));
    EXPECT_TRUE(i > 5 || !smoother->scattered()) << i;
    EXPECT_TRUE(i < 11 || smoother->scattered()) << i;
    EXPECT_TRUE(!smoother->scattered() || angle_between(out, newest) < 1e-7) << i;
  }
  smoother->reset(Quat::Identity(), 12);
  EXPECT_FALSE(smoother->scattered());
}

TEST(OrientationSmoother, KeepsAnAxisThatAllSamplesKeep) {
  Dice dice(36);
  auto smoother = std::make_unique<OrientationSmoother>();
  const Vec3 axis = dice.unit();
  const Quat aligned = dice.turn(3.0);
  const Vec3 axis_T = aligned.conjugate() * axis;
  smoother->reset(aligned, kPublishedLength);
  double angle = 0.0;
  for (int i = 0; i < 3000; ++i) {
    angle += dice.between(-0.01, 0.02);
    const Quat out = smoother->push((rotation_exp(angle * axis) * aligned).normalized());
    ASSERT_LT((out * axis_T).cross(axis).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace handrail
