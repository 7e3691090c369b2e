// A payload is found again from noisy readings, as well as the noise and the orientations allow.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <vector>

#include "server/base/random.h"
#include "server/task/payload_fit.h"
#include "tests/property/draws.h"

namespace handrail {
namespace {

using test::below;
using test::between;
using test::within;

// Standard deviations of the fit, from the orientations alone: the biases are free, so only what
// gravity differs from its mean tells anything.
struct Expected {
  double weight;
  Mat3 centre;  // covariance, with the weight known

  Expected(const std::vector<PayloadSample>& samples, double mass, double force, double torque) {
    Mat3 moments = Mat3::Zero();
    Vec3 mean = Vec3::Zero();
    const double n = static_cast<double>(samples.size());
    for (const auto& s : samples) mean -= s.q_ST.conjugate() * Vec3(0, 0, 1) / n;
    for (const auto& s : samples) {
      const Vec3 d = Vec3(s.q_ST.conjugate() * Vec3(0, 0, -1)) - mean;
      moments += d * d.transpose();
    }
    const Mat3 of_centre = moments.trace() * Mat3::Identity() - moments;
    weight = force / std::sqrt(moments.trace());
    const double share = torque / (mass * 9.80665);
    centre = share * share * of_centre.inverse();
  }
};

RC_GTEST_PROP(PayloadProperty, IsFoundAgainWithinTheNoise, ()) {
  const Payload payload{between(0.1, 5.0), within(0.1), {within(20.0), within(1.0)}};
  const double force = between(0.0, 0.05), torque = between(0.0, 0.003);
  Random random(static_cast<std::uint64_t>(below(1'000'000)));
  const auto noise = [&](double size) -> Vec3 {
    return size * Vec3(random.normal(), random.normal(), random.normal());
  };
  std::vector<PayloadSample> samples(static_cast<std::size_t>(4 + below(20)));
  for (PayloadSample& s : samples) {
    s.q_ST = rotation_exp(within(2.0));
    const Vec3 weight = s.q_ST.toRotationMatrix().transpose() * Vec3(0, 0, -9.80665 * payload.mass);
    s.raw_T = {weight + payload.bias_T.force + noise(force),
               payload.centre_T.cross(weight) + payload.bias_T.torque + noise(torque)};
    s.force_noise = force;
    s.torque_noise = torque;
  }
  const Result<PayloadFit> fit = fit_payload(samples);
  if (payload_spread(samples) < kLeastPayloadSpread) {
    RC_ASSERT(!fit);
    return;
  }
  RC_ASSERT(fit.message() == std::string());
  const Expected sigma(samples, payload.mass, force, torque);
  constexpr double kSigmas = 6.0, kRounding = 1e-9;
  const double off = (fit->payload.mass - payload.mass) * 9.80665;
  RC_ASSERT(std::abs(off) < kSigmas * sigma.weight + kRounding);
  // A weight found too large makes the centre too near by the same share.
  const double of_weight = kSigmas * sigma.weight / (9.80665 * payload.mass);
  const Vec3 beside = fit->payload.centre_T - payload.centre_T;
  for (int i = 0; i < 3; ++i) {
    RC_ASSERT(std::abs(beside[i]) < 1.5 * (kSigmas * std::sqrt(sigma.centre(i, i)) +
                                           of_weight * std::abs(payload.centre_T[i])) +
                                        kRounding);
  }
  // No worse than the noise, and not by fitting it away either: 6 or 9 values are fitted of 3 n.
  const double n = static_cast<double>(samples.size());
  RC_ASSERT(fit->force_left < force * (1.0 + 4.0 / std::sqrt(3.0 * n)) + kRounding);
  RC_ASSERT(fit->force_left >
            force * (1.0 - 4.0 / std::sqrt(3.0 * n)) * std::sqrt(1.0 - 4.0 / (3.0 * n)) -
                kRounding);
  // What is left of the readings is what the environment would do: noise, and no more.
  for (const PayloadSample& s : samples) {
    RC_ASSERT(fit->payload.remove(s.raw_T, s.q_ST).force.norm() < 9.0 * force + kRounding);
  }
}

}  // namespace
}  // namespace handrail
