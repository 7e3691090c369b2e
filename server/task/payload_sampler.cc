#include "server/task/payload_sampler.h"

#include <algorithm>
#include <numbers>

namespace handrail {
namespace {

constexpr std::size_t kFewestReadings = 20;

Vec3 down_in_turned_tip(const Quat& q_ST) { return q_ST.conjugate() * Vec3(0, 0, -1); }

double angle(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

PayloadSample mean_of(const std::vector<PayloadReading>& readings) {
  const double n = static_cast<double>(readings.size());
  const Quat& first = readings.front().X_ST.q;
  Eigen::Vector4d q = Eigen::Vector4d::Zero();
  PayloadSample out;
  for (const PayloadReading& r : readings) {
    q += std::copysign(1.0, r.X_ST.q.dot(first)) * r.X_ST.q.coeffs();
    out.raw_T.force += r.raw_T.force / n;
    out.raw_T.torque += r.raw_T.torque / n;
  }
  out.q_ST.coeffs() = q.normalized();
  double force = 0.0, torque = 0.0;
  for (const PayloadReading& r : readings) {
    force += (r.raw_T.force - out.raw_T.force).squaredNorm();
    torque += (r.raw_T.torque - out.raw_T.torque).squaredNorm();
  }
  const double axes = 3.0 * (n - 1.0);
  out.force_noise = std::sqrt(force / axes / n);
  out.torque_noise = std::sqrt(torque / axes / n);
  return out;
}

}  // namespace

PayloadSampler::State PayloadSampler::add(const PayloadReading& reading) {
  const Vec3 down = down_in_turned_tip(reading.X_ST.q);
  turned_ = std::numbers::pi;
  for (const PayloadSample& s : samples_) {
    turned_ = std::min(turned_, angle(down, down_in_turned_tip(s.q_ST)));
  }
  if (!window_.empty()) {
    const Pose& stand = window_.front().X_ST;
    moved_ = (reading.X_ST.p - stand.p).norm();
    moved_turn_ = angle_between(reading.X_ST.q, stand.q);
    if (moved_ > kStill || moved_turn_ > kStillTurn) {
      window_.clear();
      window_.push_back(reading);
      return State::kMoving;
    }
  }
  if (turned_ < kTurn) {
    window_.clear();
    return State::kKnown;
  }
  window_.push_back(reading);
  if (stood() < kStand || window_.size() < kFewestReadings) return State::kStanding;
  samples_.push_back(mean_of(window_));
  window_.clear();
  turned_ = 0.0;
  return State::kTaken;
}

}  // namespace handrail
