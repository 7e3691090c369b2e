// A recorded hand motion, played back without steps whatever its rate.
#pragma once

#include <cstddef>
#include <vector>

#include "devices/hand/min_jerk.h"
#include "server/base/spatial.h"

namespace handrail {

// Longest spacing of samples that still counts as one motion [s].
inline constexpr double kLongestSampleSpacing = 0.25;

struct RecordedSample {
  double t = 0.0;         // [s]
  Vec3 p = Vec3::Zero();  // [m]
};

// Samples joined by a curve with a continuous velocity: piecewise cubic Hermite with slopes after
// Fritsch and Carlson (1980) in the three-point form of Fritsch and Butland (1984), each axis by
// itself, so that between two samples the curve never leaves the box they span. A gap, a spacing
// over kLongestSampleSpacing, is bridged by a minimum-jerk move between two rests. Before the first
// and after the last sample the motion rests there. Immutable: safe to read from any thread.
class RecordedMotion {
 public:
  // At least two finite samples at least 1 us apart in rising order. Time and place are shifted:
  // the first sample is at t = 0, the centre of the samples' bounding box at the origin.
  explicit RecordedMotion(std::vector<RecordedSample> samples);

  std::size_t rows() const noexcept { return samples_.size(); }
  std::size_t gaps() const noexcept { return gaps_; }
  double duration() const noexcept { return samples_.back().t; }  // [s]
  const std::vector<RecordedSample>& samples() const noexcept { return samples_; }
  const Vec3& half_extent() const noexcept { return half_extent_; }  // of the box [m]

  // Position `t` seconds after the first sample [m], any finite t. Real-time safe, O(log rows).
  Vec3 at(double t) const noexcept { return motion_at(t).p; }
  // The curve's own velocity there [m/s].
  Vec3 velocity(double t) const noexcept { return motion_at(t).v; }
  // Position and velocity together; the acceleration is not filled in.
  VectorMotion motion_at(double t) const noexcept;

 private:
  bool is_gap(std::size_t i) const noexcept;  // between samples i and i + 1
  Vec3 slope(std::size_t i) const noexcept;   // at sample i [m/s]

  std::vector<RecordedSample> samples_;
  std::size_t gaps_ = 0;
  Vec3 half_extent_ = Vec3::Zero();
};

}  // namespace handrail
