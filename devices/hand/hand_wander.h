// The unintended motion of a simulated hand: physiological tremor and slow drift, seeded.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "server/base/random.h"
#include "server/base/spatial.h"

namespace handrail {

// Slow wander of position and orientation: white noise through two first-order lags. Starts at zero
// and settles to the given root mean squares, each of three axes together. The noise comes in steps
// of 4 ms on the drift's own clock, and what lies between is in closed form: any split of a span of
// time takes the same numbers and gives the same drift, but for rounding.
class SlowDrift {
 public:
  // Of the translation [m] and the rotation vector [rad].
  SlowDrift(double rms, double rotation_rms) noexcept;
  // Advances by dt > 0 [s], drawing six normal numbers every 4 ms unless both parts are zero.
  void step(double dt, Random& random) noexcept;
  auto translation() const noexcept { return value_.head<3>(); }  // [m]
  auto rotation() const noexcept { return value_.tail<3>(); }     // vector [rad]
  Vec3 velocity() const noexcept;                                 // of the translation [m/s]

 private:
  using Vec6 = Eigen::Matrix<double, 6, 1>;
  void settle(double dt) noexcept;
  void draw(Random& random) noexcept;

  double keep_;  // share of `input_` that outlasts 4 ms
  Vec6 fresh_;   // standard deviation of each new part of `input_`
  Vec6 input_ = Vec6::Zero();
  Vec6 value_ = Vec6::Zero();
  double to_draw_;          // [s]
  double settle_dt_ = 0.0;  // what `left_` is for [s]
  double left_ = 1.0;       // share of a difference that outlasts `settle_dt_`
};

// A sum of sines of random phase, spread over 8 to 12 Hz, the same root mean square on each axis.
class Tremor {
 public:
  // `rms` of the three axes together [m].
  Tremor(double rms, Random& random) noexcept;
  // Advances by dt > 0 [s]. Cheap while dt stays the same.
  void step(double dt) noexcept;
  const Vec3& value() const noexcept { return value_; }  // [m]
  const Vec3& rate() const noexcept { return rate_; }    // [m/s]

 private:
  static constexpr int kSines = 6;
  using Sines = Eigen::Array<double, kSines, 3>;  // one column an axis
  void update() noexcept;

  double amplitude_;  // of one sine [m]
  Sines omega_;       // [rad/s]
  // Each sine is a unit phasor, turned by one fixed rotation a step.
  Sines sin_, cos_;
  double turn_dt_ = 0.0;  // what the rotation is for [s]
  Sines turn_sin_, turn_cos_;
  Vec3 value_ = Vec3::Zero();
  Vec3 rate_ = Vec3::Zero();
};

// Both together, at the stylus tip, frame M. The tremor's sideways part pivots the stylus, so it
// shows in the orientation too. Any split of a span of time gives the same motion, but for
// rounding. Pure: time comes as dt; real-time safe.
class HandWander {
 public:
  HandWander(std::uint64_t seed, double tremor_rms, double drift_rms,
             double drift_rotation_rms) noexcept;
  void step(double dt) noexcept;
  Vec3 position() const noexcept { return tremor_.value() + drift_.translation(); }  // [m]
  Vec3 velocity() const noexcept { return tremor_.rate() + drift_.velocity(); }      // [m/s]
  Vec3 rotation() const noexcept;                                                    // vector [rad]

 private:
  Random random_;
  Tremor tremor_;
  SlowDrift drift_;
};

}  // namespace handrail
