#include "server/task/payload_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cstdio>

namespace handrail {
namespace {

constexpr double kLeastWeight = 0.2;  // one below it shows neither sign nor centre [N]
constexpr double kTrueShare = 0.03;   // of the weight: what a sensor's own errors may be
constexpr double kTrueForce = 0.15;   // [N]
constexpr double kTrueTorque = 0.02;  // [N m]
constexpr double kSigmas = 6.0;

Vec3 down_in_tip(const PayloadSample& sample) { return sample.q_ST.conjugate() * Vec3(0, 0, -1); }

Mat3 cross_of(const Vec3& v) {
  return (Mat3() << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0).finished();
}

// Least squares for x in `rows` x = `values`.
template <int N>
Eigen::Matrix<double, N, 1> solve(const Eigen::MatrixXd& rows, const Eigen::VectorXd& values) {
  return rows.colPivHouseholderQr().solve(values);
}

// The sample that `payload` explains least, by the larger of its two parts, each as a share of what
// is allowed for it.
struct Worst {
  std::size_t sample = 0;
  double share = 0.0;
  bool in_torque = false;
  double left = 0.0, allowed = 0.0;  // [N] or [N m]
};

Worst judge(std::span<const PayloadSample> samples, double weight, PayloadFit& fit) {
  Worst worst;
  double force = 0.0, torque = 0.0;
  const auto see = [&worst](std::size_t i, bool in_torque, double left, double allowed) {
    if (left <= worst.share * allowed) return;
    worst = {i, left / allowed, in_torque, left, allowed};
  };
  const double lever = fit.payload.centre_T.norm();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const PayloadSample& s = samples[i];
    const Wrench left = fit.payload.remove(s.raw_T, s.q_ST);
    force += left.force.squaredNorm();
    torque += left.torque.squaredNorm();
    const double of_weight = kTrueShare * std::abs(weight);
    see(i, false, left.force.norm(), std::max(kTrueForce, of_weight) + kSigmas * s.force_noise);
    see(i, true, left.torque.norm(),
        std::max(kTrueTorque, of_weight * lever) + kSigmas * s.torque_noise);
  }
  const double axes = 3.0 * static_cast<double>(samples.size());
  fit.force_left = std::sqrt(force / axes);
  fit.torque_left = std::sqrt(torque / axes);
  return worst;
}

template <typename... Values>
Status error(const char* format, Values... values) {
  char text[320];
  std::snprintf(text, sizeof text, format, values...);
  return Status::error(text);
}

}  // namespace

double payload_spread(std::span<const PayloadSample> samples) noexcept {
  if (samples.empty()) return 0.0;
  const double share = 1.0 / static_cast<double>(samples.size());
  Vec3 mean = Vec3::Zero();
  for (const PayloadSample& s : samples) mean += share * down_in_tip(s);
  Mat3 moments = Mat3::Zero();
  for (const PayloadSample& s : samples) {
    const Vec3 d = down_in_tip(s) - mean;
    moments += share * d * d.transpose();
  }
  const Vec3 along = Eigen::SelfAdjointEigenSolver<Mat3>(moments).eigenvalues();  // rising
  return std::sqrt(std::max(0.0, along[0] + along[1]));
}

Result<PayloadFit> fit_payload(std::span<const PayloadSample> samples) {
  if (samples.size() < kFewestPayloadSamples) {
    return error("%zu orientations are too few, expected at least %zu", samples.size(),
                 kFewestPayloadSamples);
  }
  const double spread = payload_spread(samples);
  if (spread < kLeastPayloadSpread) {
    return error(
        "the orientations are too much alike (gravity spreads by %.2f across its main direction in "
        "the tip frame, expected at least %.2f): tilt the tip by 20 deg or more to several sides; "
        "turning it about the vertical shows nothing",
        spread, kLeastPayloadSpread);
  }
  // Force: weight x down + bias. Torque: centre x (weight x down) + bias.
  const auto n = static_cast<Eigen::Index>(samples.size());
  Eigen::MatrixXd of_force(3 * n, 4), of_torque(3 * n, 6);
  Eigen::VectorXd force(3 * n), torque(3 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const PayloadSample& s = samples[static_cast<std::size_t>(i)];
    of_force.middleRows<3>(3 * i) << down_in_tip(s), Mat3::Identity();
    force.segment<3>(3 * i) = s.raw_T.force;
    torque.segment<3>(3 * i) = s.raw_T.torque;
  }
  const Eigen::Vector4d w = solve<4>(of_force, force);
  const double weight = w[0];
  PayloadFit fit;
  fit.payload.mass = weight / kStandardGravity;
  fit.payload.bias_T.force = w.tail<3>();
  if (std::abs(weight) < kLeastWeight) {
    fit.payload.mass = std::max(0.0, fit.payload.mass);
    for (const PayloadSample& s : samples) {
      fit.payload.bias_T.torque += s.raw_T.torque / static_cast<double>(n);
    }
  } else {
    for (Eigen::Index i = 0; i < n; ++i) {
      const Vec3 down = down_in_tip(samples[static_cast<std::size_t>(i)]);
      of_torque.middleRows<3>(3 * i) << -cross_of(weight * down), Mat3::Identity();
    }
    const Eigen::Matrix<double, 6, 1> t = solve<6>(of_torque, torque);
    fit.payload.centre_T = t.head<3>();
    fit.payload.bias_T.torque = t.tail<3>();
  }
  const Worst worst = judge(samples, weight, fit);
  if (worst.share > 1.0) {
    return error(
        "no payload explains the readings: orientation %zu is off by %.3g %s, expected at most "
        "%.2g: the arm touched something or moved, or the sensor's axes are not the tip's",
        worst.sample + 1, worst.left, worst.in_torque ? "N m" : "N", worst.allowed);
  }
  if (weight <= -kLeastWeight) {
    return error("the weight points up (%.2f kg): the sensor's sign is reversed", fit.payload.mass);
  }
  return fit;
}

}  // namespace handrail
