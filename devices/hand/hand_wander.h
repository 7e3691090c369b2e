// The unintended motion of a simulated hand: physiological tremor and slow drift, seeded.
#pragma once

#include <array>
#include <cstdint>

#include "server/base/random.h"
#include "server/base/spatial.h"

namespace handrail {

// White noise through two first-order lags, so that position and velocity are continuous. Starts at
// zero and settles to the given root mean square, all three axes together.
class SlowDrift {
 public:
  explicit SlowDrift(double rms) noexcept;
  // Advances by dt > 0 [s], drawing three normal numbers unless the drift is zero.
  void step(double dt, Random& random) noexcept;
  const Vec3& value() const noexcept { return value_; }
  Vec3 rate() const noexcept;  // [1/s]

 private:
  double sigma_;  // of one axis of `input_`
  Vec3 input_ = Vec3::Zero();
  Vec3 value_ = Vec3::Zero();
};

// A sum of sines of random phase, spread over 8 to 12 Hz, the same root mean square on each axis.
class Tremor {
 public:
  // `rms` of the three axes together [m].
  Tremor(double rms, Random& random) noexcept;
  void step(double dt) noexcept;
  const Vec3& value() const noexcept { return value_; }  // [m]
  const Vec3& rate() const noexcept { return rate_; }    // [m/s]

 private:
  static constexpr int kSines = 6;
  struct Sine {
    double omega = 0.0;  // [rad/s]
    double phase = 0.0;  // [rad]
  };
  void update() noexcept;

  double amplitude_;  // of one sine [m]
  double t_ = 0.0;    // [s]
  std::array<std::array<Sine, kSines>, 3> sines_;
  Vec3 value_ = Vec3::Zero();
  Vec3 rate_ = Vec3::Zero();
};

// Both together, at the stylus tip, frame M. The tremor's sideways part pivots the stylus, so it
// shows in the orientation too. Pure: time comes as dt; real-time safe.
class HandWander {
 public:
  HandWander(std::uint64_t seed, double tremor_rms, double drift_rms,
             double drift_rotation_rms) noexcept;
  void step(double dt) noexcept;
  Vec3 position() const noexcept { return tremor_.value() + drift_.value(); }  // [m]
  Vec3 velocity() const noexcept { return tremor_.rate() + drift_.rate(); }    // [m/s]
  Vec3 rotation() const noexcept;                                              // vector [rad]

 private:
  Random random_;
  Tremor tremor_;
  SlowDrift drift_;
  SlowDrift turn_drift_;
};

}  // namespace handrail
