// Command smoother (dissertation 3.11): the mean of the last N samples.
#pragma once

#include <array>
#include <cstddef>

#include "server/base/spatial.h"

namespace handrail {

inline constexpr int kMaxSmootherLength = 1000;

// Mean of the last N values of a vector. Two running sums: one is used, the other is rebuilt from
// additions alone and replaces it once a turn, so that rounding never accumulates over days.
// Equal samples give exactly that value. Real-time safe, O(1).
template <int Size>
class RunningMean {
 public:
  using Value = Eigen::Matrix<double, Size, 1>;

  // As if the last N samples had all been `value`. 1 <= length <= kMaxSmootherLength.
  void reset(const Value& value, int length) noexcept {
    origin_ = last_ = value;
    equal_ = length_ = length;
    next_ = 0;
    wrapped_ = false;
    sum_.setZero();
    rebuilt_.setZero();
  }

  // Adds one sample and returns the mean.
  Value push(const Value& value) noexcept {
    // Relative to the start of the window's life: small numbers, and exact zeros for a still hand.
    const Value relative = value - origin_;
    const auto slot = static_cast<std::size_t>(next_);
    if (wrapped_) sum_ -= samples_[slot];
    samples_[slot] = relative;
    sum_ += relative;
    rebuilt_ += relative;
    if (++next_ == length_) {
      next_ = 0;
      wrapped_ = true;
      sum_ = rebuilt_;
      rebuilt_.setZero();
    }
    // A hand at rest commands exactly its pose, not one that differs in the last digits.
    equal_ = value == last_ ? equal_ + (equal_ < length_) : 1;
    last_ = value;
    return equal_ == length_ ? value : Value(origin_ + sum_ / length_);
  }

 private:
  std::array<Value, kMaxSmootherLength> samples_;
  Value origin_ = Value::Zero();
  Value sum_ = Value::Zero();
  Value rebuilt_ = Value::Zero();
  Value last_ = Value::Zero();
  int length_ = 1;
  int equal_ = 1;  // newest samples that are the same, at most length_
  int next_ = 0;
  bool wrapped_ = false;
};

// Position smoother, frame S [m].
using PositionSmoother = RunningMean<3>;

// Mean orientation of the last N samples: the normalised sum of quaternions, each taken with the
// sign nearest its predecessor (q and -q are the same rotation). Where samples are scattered all
// round, their mean has no direction to follow and the newest is returned: whoever follows eases
// over to it. Real-time safe, O(1).
class OrientationSmoother {
 public:
  // Length of a mean that has a direction, at least. Chosen: samples that turn steadily come to it
  // at 430 degrees a window, which no hand does; and no mean that long turns by more than
  // 2 asin(2 / (kLeast N)) a sample, 2.3 degrees for 200.
  static constexpr double kLeast = 0.5;

  void reset(const Quat& q, int length) noexcept {
    last_ = q.coeffs();
    mean_.reset(last_, length);
    scattered_ = false;
  }
  Quat push(const Quat& q) noexcept {
    last_ = q.coeffs().dot(last_) < 0.0 ? Eigen::Vector4d(-q.coeffs()) : q.coeffs();
    const Eigen::Vector4d mean = mean_.push(last_);
    const double norm = mean.norm();
    scattered_ = norm < kLeast;
    return scattered_ ? Quat(last_) : Quat(Eigen::Vector4d(mean / norm));
  }
  // The last push found no direction.
  bool scattered() const noexcept { return scattered_; }

 private:
  RunningMean<4> mean_;
  Eigen::Vector4d last_ = Eigen::Vector4d::UnitW();
  bool scattered_ = false;
};

}  // namespace handrail
