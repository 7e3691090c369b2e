#include "devices/hand/recorded_hand.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace handrail {
namespace {

RecordedMotion zigzag() {
  return RecordedMotion({{10.0, {0.00, 0.00, 0.0}},
                         {10.1, {0.02, 0.01, 0.0}},
                         {10.2, {0.03, 0.05, 0.0}},
                         {10.25, {0.03, 0.04, 0.0}},
                         {10.4, {0.10, 0.00, 0.0}}});
}

TEST(RecordedMotion, PassesThroughEverySampleCentredAndStartingAtZero) {
  const RecordedMotion motion = zigzag();
  const Vec3 centre(0.05, 0.025, 0.0);
  EXPECT_LT((motion.at(0.0) - (Vec3(0.0, 0.0, 0.0) - centre)).norm(), 1e-12);
  EXPECT_LT((motion.at(0.1) - (Vec3(0.02, 0.01, 0.0) - centre)).norm(), 1e-9);
  EXPECT_LT((motion.at(0.25) - (Vec3(0.03, 0.04, 0.0) - centre)).norm(), 1e-9);
  EXPECT_LT((motion.at(0.4) - (Vec3(0.10, 0.0, 0.0) - centre)).norm(), 1e-9);
  EXPECT_NEAR(motion.duration(), 0.4, 1e-12);
  EXPECT_EQ(motion.rows(), 5u);
  EXPECT_EQ(motion.gaps(), 0u);
  EXPECT_LT((motion.half_extent() - centre).norm(), 1e-12);
}

TEST(RecordedMotion, NeverLeavesTheBoxOfTheTwoSamplesAround) {
  const RecordedMotion motion = zigzag();
  const auto& s = motion.samples();
  for (std::size_t i = 0; i + 1 < s.size(); ++i) {
    const Vec3 low = s[i].p.cwiseMin(s[i + 1].p);
    const Vec3 high = s[i].p.cwiseMax(s[i + 1].p);
    for (int k = 0; k < 200; ++k) {
      const Vec3 p = motion.at(s[i].t + (s[i + 1].t - s[i].t) * k / 200.0);
      EXPECT_TRUE((p.array() >= low.array() - 1e-15).all());
      EXPECT_TRUE((p.array() <= high.array() + 1e-15).all());
    }
  }
}

TEST(RecordedMotion, VelocityIsContinuousAndTheRateOfThePosition) {
  const RecordedMotion motion = zigzag();
  constexpr double kStep = 1e-5;
  Vec3 last = motion.velocity(-kStep);
  for (double t = 0.0; t < 0.5; t += kStep) {
    const Vec3 v = motion.velocity(t);
    EXPECT_LT((v - last).norm(), 100.0 * kStep) << t;
    const Vec3 rate = (motion.at(t + 0.5 * kStep) - motion.at(t - 0.5 * kStep)) / kStep;
    EXPECT_LT((v - rate).norm(), 1e-3) << t;
    last = v;
  }
}

TEST(RecordedMotion, KeepsAnEvenSpeedBetweenEvenSamples) {
  std::vector<RecordedSample> samples;
  for (int i = 0; i <= 10; ++i) samples.push_back({0.1 * i, Vec3(0.01 * i, 0.0, 0.0)});
  const RecordedMotion motion(samples);
  for (double t = 0.1; t < 0.9; t += 0.003) EXPECT_NEAR(motion.velocity(t).x(), 0.1, 1e-9);
}

TEST(RecordedMotion, RestsBeforeTheFirstAndAfterTheLastSample) {
  const RecordedMotion motion = zigzag();
  EXPECT_EQ(motion.at(-5.0), motion.samples().front().p);
  EXPECT_EQ(motion.at(99.0), motion.samples().back().p);
  EXPECT_EQ(motion.at(std::numeric_limits<double>::quiet_NaN()), motion.samples().front().p);
  EXPECT_EQ(motion.velocity(-5.0), Vec3::Zero());
  EXPECT_EQ(motion.velocity(0.0), Vec3::Zero());
  EXPECT_EQ(motion.velocity(99.0), Vec3::Zero());
  EXPECT_EQ(motion.velocity(motion.duration()), Vec3::Zero());
}

TEST(RecordedMotion, CountsAGapAt251MillisecondsButNotAt250) {
  const auto spaced = [](double gap) {
    return RecordedMotion({{1.0, Vec3::Zero()},
                           {1.1, Vec3(0.01, 0.0, 0.0)},
                           {1.1 + gap, Vec3(0.02, 0.0, 0.0)},
                           {1.2 + gap, Vec3(0.03, 0.0, 0.0)}});
  };
  EXPECT_EQ(spaced(0.250).gaps(), 0u);
  EXPECT_EQ(spaced(0.251).gaps(), 1u);
}

TEST(RecordedMotion, BridgesAGapByAMinimumJerkMoveBetweenRests) {
  const RecordedMotion motion({{0.0, Vec3::Zero()},
                               {0.1, Vec3(0.01, 0.0, 0.0)},
                               {1.1, Vec3(0.11, 0.0, 0.0)},
                               {1.2, Vec3(0.12, 0.0, 0.0)}});
  EXPECT_EQ(motion.gaps(), 1u);
  EXPECT_LT(motion.velocity(0.1).norm(), 1e-9);
  EXPECT_LT(motion.velocity(1.1).norm(), 1e-9);
  EXPECT_NEAR(motion.velocity(0.6).x(), 1.875 * 0.1, 1e-9);
  double fastest = 0.0;
  for (double t = 0.1; t < 1.1; t += 1e-3) fastest = std::max(fastest, motion.velocity(t).x());
  EXPECT_NEAR(fastest, 0.1875, 1e-6);
}

}  // namespace
}  // namespace handrail
