#include "server/task/payload_fit.h"

#include <gtest/gtest.h>

#include "tests/unit/task/payload_samples.h"

namespace handrail {
namespace {

using test::half_a_kilogram;
using test::leaning;
using test::samples_of;

void expect_same(const Payload& a, const Payload& b, double tolerance) {
  EXPECT_NEAR(a.mass, b.mass, tolerance);
  EXPECT_LT((a.centre_T - b.centre_T).norm(), tolerance);
  EXPECT_LT((a.bias_T.force - b.bias_T.force).norm(), tolerance);
  EXPECT_LT((a.bias_T.torque - b.bias_T.torque).norm(), tolerance);
}

TEST(PayloadFit, SixPosesGiveMassCentreAndBias) {
  const auto fit = fit_payload(samples_of(half_a_kilogram(), leaning(5, 0.6)));
  ASSERT_TRUE(fit) << fit.message();
  expect_same(fit->payload, half_a_kilogram(), 1e-12);
  EXPECT_LT(fit->force_left, 1e-12);
  EXPECT_LT(fit->torque_left, 1e-12);
}

TEST(PayloadFit, TiltingToOneSideIsEnoughWhenItIsFar) {
  std::vector<Quat> turns;
  for (const double lean : {-1.2, -0.6, 0.0, 0.6, 1.2}) turns.push_back(rotation_exp({lean, 0, 0}));
  const auto fit = fit_payload(samples_of(half_a_kilogram(), turns));
  ASSERT_TRUE(fit) << fit.message();
  expect_same(fit->payload, half_a_kilogram(), 1e-11);
}

TEST(PayloadFit, ThreePosesAreTooFew) {
  const auto fit = fit_payload(samples_of(half_a_kilogram(), leaning(2, 0.6)));
  EXPECT_EQ(fit.message(), "3 orientations are too few, expected at least 4");
  EXPECT_EQ(fit_payload({}).message(), "0 orientations are too few, expected at least 4");
}

TEST(PayloadFit, TurningAboutTheVerticalOnlyIsRefused) {
  std::vector<Quat> turns;
  for (int i = 0; i < 12; ++i) {
    turns.push_back(rotation_exp(Vec3(0, 0, 0.5 * i)) * rotation_exp(Vec3(M_PI, 0, 0)));
  }
  const auto fit = fit_payload(samples_of(half_a_kilogram(), turns));
  EXPECT_NE(fit.message().find("too much alike"), std::string::npos) << fit.message();
  EXPECT_NE(fit.message().find("about the vertical shows nothing"), std::string::npos);
}

TEST(PayloadFit, LeaningByTenDegreesIsTooLittleAndTwentyIsEnough) {
  EXPECT_FALSE(fit_payload(samples_of(half_a_kilogram(), leaning(5, 0.17))));
  EXPECT_TRUE(fit_payload(samples_of(half_a_kilogram(), leaning(5, 0.35))));
}

TEST(PayloadFit, AReversedSensorIsNamed) {
  auto samples = samples_of(half_a_kilogram(), leaning(5, 0.6));
  for (PayloadSample& s : samples) {
    s.raw_T = {-s.raw_T.force, -s.raw_T.torque};
  }
  EXPECT_EQ(fit_payload(samples).message(),
            "the weight points up (-0.50 kg): the sensor's sign is reversed");
}

TEST(PayloadFit, TouchingDuringCalibrationIsFound) {
  for (std::size_t touched = 0; touched < 6; ++touched) {
    for (const Vec3& push : {Vec3(0.6, 0, 0), Vec3(0, -0.6, 0), Vec3(0, 0, 0.6)}) {
      auto samples = samples_of(half_a_kilogram(), leaning(5, 0.6));
      samples[touched].raw_T.force += push;
      const auto fit = fit_payload(samples);
      EXPECT_NE(fit.message().find("touched something or moved"), std::string::npos)
          << touched << ": " << fit.message();
    }
  }
}

TEST(PayloadFit, ATouchThatShowsInTheTorqueAloneIsFoundAndItsPoseNamed) {
  auto samples = samples_of(half_a_kilogram(), leaning(5, 0.6));
  samples[3].raw_T.torque += Vec3(0, 0, 0.1);
  const auto fit = fit_payload(samples);
  EXPECT_NE(fit.message().find("orientation 4 is off by "), std::string::npos) << fit.message();
  EXPECT_NE(fit.message().find(" N m, "), std::string::npos) << fit.message();
}

TEST(PayloadFit, SwappedAxesOfTheSensorAreFound) {
  auto samples = samples_of(half_a_kilogram(), leaning(5, 0.6));
  for (PayloadSample& s : samples) std::swap(s.raw_T.force.x(), s.raw_T.force.y());
  const auto fit = fit_payload(samples);
  EXPECT_NE(fit.message().find("axes are not the tip's"), std::string::npos) << fit.message();
}

TEST(PayloadFit, NoiseOfTheSensorIsNoTouch) {
  auto samples = samples_of(half_a_kilogram(), leaning(5, 0.6));
  const double sign[] = {1, -1, 1, -1, 1, -1};
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].raw_T.force.x() += sign[i] * 0.4;
    samples[i].force_noise = 0.2;
  }
  EXPECT_TRUE(fit_payload(samples)) << fit_payload(samples).message();
}

TEST(PayloadFit, NothingOnTheSensorIsABiasAlone) {
  Payload none = half_a_kilogram();
  none.mass = 0.0;
  const auto fit = fit_payload(samples_of(none, leaning(5, 0.6)));
  ASSERT_TRUE(fit) << fit.message();
  none.centre_T.setZero();
  expect_same(fit->payload, none, 1e-12);
  EXPECT_GE(fit->payload.mass, 0.0);
}

TEST(Payload, WhatItReadsIsWhatIsRemoved) {
  const Payload p = half_a_kilogram();
  const Wrench touch{{3.0, -1.0, 2.0}, {0.1, 0.2, -0.3}};
  for (const PayloadSample& s : samples_of(p, leaning(7, 1.3))) {
    const Wrench left =
        p.remove({s.raw_T.force + touch.force, s.raw_T.torque + touch.torque}, s.q_ST);
    EXPECT_LT((left.force - touch.force).norm(), 1e-13);
    EXPECT_LT((left.torque - touch.torque).norm(), 1e-13);
  }
}

TEST(Payload, NoneLeavesEveryBitAlone) {
  EXPECT_TRUE(Payload().is_none());
  const Wrench raw{{-0.0, 1e-300, 3.0}, {-0.0, 0.0, -1e300}};
  const Wrench left = Payload().remove(raw, leaning(3, 0.5)[2]);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(std::signbit(left.force[i]), std::signbit(raw.force[i]));
    EXPECT_EQ(left.force[i], raw.force[i]);
    EXPECT_EQ(std::signbit(left.torque[i]), std::signbit(raw.torque[i]));
    EXPECT_EQ(left.torque[i], raw.torque[i]);
  }
}

}  // namespace
}  // namespace handrail
