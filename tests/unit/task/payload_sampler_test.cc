#include "server/task/payload_sampler.h"

#include <gtest/gtest.h>

#include "tests/unit/task/payload_samples.h"

namespace handrail {
namespace {

using State = PayloadSampler::State;

class Arm {
 public:
  // Stands for `seconds` at X with readings every 20 ms; how often a sample was taken.
  int stand(const Pose& X, double seconds, const Wrench& raw = {}) {
    int taken = 0;
    for (const double end = t_ + seconds; t_ < end; t_ += 0.02)
      taken += add(X, raw) == State::kTaken;
    return taken;
  }
  State add(const Pose& X, const Wrench& raw = {}) { return last = sampler.add({t_, X, raw}); }
  PayloadSampler sampler;
  State last = State::kMoving;

 private:
  double t_ = 5.0;
};

Pose leaning(double angle) { return {{0.3, 0.0, 0.4}, rotation_exp(Vec3(angle, 0, 0))}; }

TEST(PayloadSampler, TakesTheMeanOverASecondAtRest) {
  Arm arm;
  EXPECT_EQ(arm.stand(leaning(0.1), 0.9, {{9, 9, 9}, {0, 0, 0}}), 0);
  EXPECT_EQ(arm.last, State::kStanding);
  EXPECT_EQ(arm.add(leaning(0.5)), State::kMoving);
  double sign = 1.0;
  for (int i = 0; i < 49; ++i, sign = -sign) {
    EXPECT_EQ(arm.stand(leaning(0.5), 0.02, {{1.0 + sign, 2, 3}, {0, 0, 4 + sign}}), 0);
  }
  EXPECT_EQ(arm.stand(leaning(0.5), 0.06, {{1, 2, 3}, {0, 0, 4}}), 1);
  ASSERT_EQ(arm.sampler.samples().size(), 1u);
  const PayloadSample& s = arm.sampler.samples()[0];
  EXPECT_LT(angle_between(s.q_ST, leaning(0.5).q), 1e-12);
  EXPECT_LT((s.raw_T.force - Vec3(1, 2, 3)).norm(), 0.09);
  EXPECT_LT((s.raw_T.torque - Vec3(0, 0, 4)).norm(), 0.15);
  // A deviation of 1 on one of three axes, 51 readings.
  EXPECT_NEAR(s.force_noise, 1.0 / std::sqrt(3.0 * 51.0), 0.01);
}

TEST(PayloadSampler, GravityFromTheSameSideIsNotTakenAgain) {
  Arm arm;
  EXPECT_EQ(arm.stand(leaning(0.0), 5.0), 1);
  EXPECT_EQ(arm.last, State::kKnown);
  // About the vertical gravity stays where it is.
  EXPECT_EQ(arm.stand({{0.3, 0, 0.4}, rotation_exp(Vec3(0, 0, 2.0))}, 5.0), 0);
  EXPECT_LT(arm.sampler.turned(), 1e-9);
  EXPECT_EQ(arm.stand(leaning(19.0 * kDeg), 5.0), 0);
  EXPECT_NEAR(arm.sampler.turned(), 19.0 * kDeg, 1e-9);
  EXPECT_EQ(arm.stand(leaning(21.0 * kDeg), 5.0), 1);
  EXPECT_EQ(arm.stand(leaning(-21.0 * kDeg), 5.0), 1);
  EXPECT_EQ(arm.stand(leaning(10.0 * kDeg), 5.0), 0);
}

TEST(PayloadSampler, AnArmThatCreepsIsNotTaken) {
  Arm arm;
  for (int i = 0; i < 500; ++i) {
    const Pose turning{{0.3, 0, 0.4}, rotation_exp(Vec3(i * 0.04 * kDeg, 0, 0))};
    EXPECT_EQ(arm.stand(turning, 0.02), 0);
  }
  for (int i = 0; i < 500; ++i) {
    EXPECT_EQ(arm.stand({{0.3 + i * 1e-4, 0, 0.4}, leaning(0.3).q}, 0.02), 0);
  }
}

TEST(PayloadSampler, AHandsDriftIsStandingAndTheMeanIsOfPoseAndReadingAlike) {
  // 1 deg and 2 mm a second; the reading follows the pose.
  Arm arm;
  int taken = 0;
  for (int i = 0; i < 52; ++i) {
    const Pose X{{0.3 + i * 4e-5, 0, 0.4}, rotation_exp(Vec3(i * 0.02 * kDeg, 0, 0))};
    taken += arm.stand(X, 0.02, {X.q.conjugate() * Vec3(0, 0, -4.9), {0, 0, 0}});
  }
  ASSERT_EQ(taken, 1);
  const PayloadSample& s = arm.sampler.samples()[0];
  EXPECT_LT((s.raw_T.force - s.q_ST.conjugate() * Vec3(0, 0, -4.9)).norm(), 1e-3);
}

TEST(PayloadSampler, AnInterruptionBeginsTheSecondAnew) {
  Arm arm;
  EXPECT_EQ(arm.stand(leaning(0.0), 0.9), 0);
  arm.sampler.interrupt();
  EXPECT_EQ(arm.sampler.stood(), 0.0);
  EXPECT_EQ(arm.stand(leaning(0.0), 0.9), 0);
  EXPECT_EQ(arm.stand(leaning(0.0), 0.2), 1);
}

}  // namespace
}  // namespace handrail
