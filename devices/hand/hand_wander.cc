#include "devices/hand/hand_wander.h"

#include <cmath>
#include <numbers>

namespace handrail {
namespace {

// Time constants of the drift, fitted to manual tele-operation results [s].
constexpr double kSlowLag = 3.0;
constexpr double kFastLag = 0.6;

// Band of physiological tremor [Hz].
constexpr double kTremorLow = 8.0;
constexpr double kTremorHigh = 12.0;

constexpr double kStylusLever = 0.05;  // tip to the grip it pivots about; our choice [m]

}  // namespace

// The second lag leaves slow / (slow + fast) of the input's variance.
SlowDrift::SlowDrift(double rms) noexcept
    : sigma_(rms / std::sqrt(3.0) * std::sqrt((kSlowLag + kFastLag) / kSlowLag)) {}

void SlowDrift::step(double dt, Random& random) noexcept {
  if (sigma_ == 0.0) return;
  const double keep = std::exp(-dt / kSlowLag);
  const double fresh = sigma_ * std::sqrt(1.0 - keep * keep);
  for (int i = 0; i < 3; ++i) input_[i] = keep * input_[i] + fresh * random.normal();
  value_ = input_ + std::exp(-dt / kFastLag) * (value_ - input_);
}

Vec3 SlowDrift::rate() const noexcept { return (input_ - value_) / kFastLag; }

Tremor::Tremor(double rms, Random& random) noexcept
    : amplitude_(rms * std::sqrt(2.0 / (3.0 * kSines))) {
  constexpr double kSlot = (kTremorHigh - kTremorLow) / kSines;
  for (auto& axis : sines_) {
    for (int i = 0; i < kSines; ++i) {
      // One frequency a slot, off the slot's edges: no two beat slower than every 4 s.
      const double hertz = kTremorLow + kSlot * (i + 0.2 + 0.6 * random.uniform());
      axis[static_cast<std::size_t>(i)] = {2.0 * std::numbers::pi * hertz,
                                           2.0 * std::numbers::pi * random.uniform()};
    }
  }
  update();
}

void Tremor::step(double dt) noexcept {
  if (amplitude_ == 0.0) return;
  t_ += dt;
  update();
}

void Tremor::update() noexcept {
  for (int i = 0; i < 3; ++i) {
    double value = 0.0;
    double rate = 0.0;
    for (const Sine& sine : sines_[static_cast<std::size_t>(i)]) {
      const double angle = sine.omega * t_ + sine.phase;
      value += std::sin(angle);
      rate += sine.omega * std::cos(angle);
    }
    value_[i] = amplitude_ * value;
    rate_[i] = amplitude_ * rate;
  }
}

HandWander::HandWander(std::uint64_t seed, double tremor_rms, double drift_rms,
                       double drift_rotation_rms) noexcept
    : random_(seed),
      tremor_(tremor_rms, random_),
      drift_(drift_rms),
      turn_drift_(drift_rotation_rms) {}

void HandWander::step(double dt) noexcept {
  tremor_.step(dt);
  drift_.step(dt, random_);
  turn_drift_.step(dt, random_);
}

Vec3 HandWander::rotation() const noexcept {
  const Vec3& sideways = tremor_.value();
  return turn_drift_.value() + Vec3(-sideways.y(), sideways.x(), 0.0) / kStylusLever;
}

}  // namespace handrail
