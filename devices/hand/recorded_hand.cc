#include "devices/hand/recorded_hand.h"

#include <algorithm>
#include <utility>

namespace handrail {
namespace {

// Decimal times are not exact in binary: 1.350 - 1.100 must not count as more than 0.250.
constexpr double kTimeRounding = 1e-6;  // [s]

}  // namespace

RecordedMotion::RecordedMotion(std::vector<RecordedSample> samples) : samples_(std::move(samples)) {
  const double start = samples_.front().t;
  Vec3 low = samples_.front().p;
  Vec3 high = low;
  for (const RecordedSample& s : samples_) {
    low = low.cwiseMin(s.p);
    high = high.cwiseMax(s.p);
  }
  half_extent_ = 0.5 * (high - low);
  const Vec3 centre = 0.5 * (high + low);
  for (RecordedSample& s : samples_) {
    s.t -= start;
    s.p -= centre;
  }
  for (std::size_t i = 0; i + 1 < samples_.size(); ++i) gaps_ += is_gap(i) ? 1 : 0;
}

VectorMotion RecordedMotion::motion_at(double t) const noexcept {
  if (!(t > 0.0)) return {samples_.front().p, Vec3::Zero(), Vec3::Zero()};
  if (t >= duration()) return {samples_.back().p, Vec3::Zero(), Vec3::Zero()};
  const auto after = std::upper_bound(samples_.begin(), samples_.end(), t,
                                      [](double at, const RecordedSample& s) { return at < s.t; });
  const auto i = static_cast<std::size_t>(after - samples_.begin()) - 1;
  const RecordedSample& a = samples_[i];
  const RecordedSample& b = samples_[i + 1];
  const double h = b.t - a.t;
  VectorMotion m;
  if (is_gap(i)) {
    m = MinJerk({a.p, Vec3::Zero(), Vec3::Zero()}, b.p, h).at(t - a.t);
  } else {
    const double s = (t - a.t) / h;
    const Vec3 d = b.p - a.p;
    const Vec3 m0 = h * slope(i);
    const Vec3 m1 = h * slope(i + 1);
    const Vec3 c2 = 3.0 * d - 2.0 * m0 - m1;
    const Vec3 c3 = m0 + m1 - 2.0 * d;
    m.p = a.p + s * (m0 + s * (c2 + s * c3));
    m.v = (m0 + s * (2.0 * c2 + s * 3.0 * c3)) / h;
  }
  // Both curves are monotone between the two samples; only rounding can leave their box.
  m.p = m.p.cwiseMax(a.p.cwiseMin(b.p)).cwiseMin(a.p.cwiseMax(b.p));
  return m;
}

bool RecordedMotion::is_gap(std::size_t i) const noexcept {
  return samples_[i + 1].t - samples_[i].t > kLongestSampleSpacing + kTimeRounding;
}

Vec3 RecordedMotion::slope(std::size_t i) const noexcept {
  // Rest at both ends and on both sides of a gap.
  if (i == 0 || i + 1 == samples_.size() || is_gap(i - 1) || is_gap(i)) return Vec3::Zero();
  const double h0 = samples_[i].t - samples_[i - 1].t;
  const double h1 = samples_[i + 1].t - samples_[i].t;
  const double w0 = 2.0 * h1 + h0;
  const double w1 = h1 + 2.0 * h0;
  Vec3 m = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const double d0 = (samples_[i].p[axis] - samples_[i - 1].p[axis]) / h0;
    const double d1 = (samples_[i + 1].p[axis] - samples_[i].p[axis]) / h1;
    // Weighted harmonic mean of the two secants; zero at a turning point.
    if (d0 * d1 > 0.0) m[axis] = (w0 + w1) / (w0 / d0 + w1 / d1);
  }
  return m;
}

}  // namespace handrail
