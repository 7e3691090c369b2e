#include "devices/hand/hand_wander.h"

#include <cmath>
#include <numbers>

namespace handrail {
namespace {

// Time constants of the drift, fitted to manual tele-operation results [s].
constexpr double kSlowLag = 3.0;
constexpr double kFastLag = 0.6;

constexpr double kDrawEvery = 4e-3;  // far below both lags: the RMS is off by some 1e-6 [s]
constexpr double kSameTime = 1e-12;  // two times closer than this differ by rounding only [s]

// Band of physiological tremor [Hz].
constexpr double kTremorLow = 8.0;
constexpr double kTremorHigh = 12.0;

constexpr double kStylusLever = 0.05;  // tip to the grip it pivots about; our choice [m]

}  // namespace

// The second lag leaves slow / (slow + fast) of the input's variance.
SlowDrift::SlowDrift(double rms, double rotation_rms) noexcept
    : keep_(std::exp(-kDrawEvery / kSlowLag)), to_draw_(kDrawEvery) {
  const double input_per_rms = std::sqrt((kSlowLag + kFastLag) / (3.0 * kSlowLag));
  const double fresh_share = std::sqrt(1.0 - keep_ * keep_);
  fresh_.head<3>().setConstant(rms * input_per_rms * fresh_share);
  fresh_.tail<3>().setConstant(rotation_rms * input_per_rms * fresh_share);
}

void SlowDrift::step(double dt, Random& random) noexcept {
  if (fresh_.isZero(0.0)) return;
  while (dt > to_draw_ + kSameTime) {
    settle(to_draw_);
    dt -= to_draw_;
    draw(random);
  }
  settle(dt);
  to_draw_ -= dt;
  if (to_draw_ <= kSameTime) draw(random);
}

void SlowDrift::settle(double dt) noexcept {
  if (dt != settle_dt_) {
    settle_dt_ = dt;
    left_ = std::exp(-dt / kFastLag);
  }
  value_ = input_ + left_ * (value_ - input_);
}

void SlowDrift::draw(Random& random) noexcept {
  for (int i = 0; i < 6; ++i) input_[i] = keep_ * input_[i] + fresh_[i] * random.normal();
  to_draw_ = kDrawEvery;
}

Vec3 SlowDrift::velocity() const noexcept { return (input_ - value_).head<3>() / kFastLag; }

Tremor::Tremor(double rms, Random& random) noexcept
    : amplitude_(rms * std::sqrt(2.0 / (3.0 * kSines))) {
  constexpr double kSlot = (kTremorHigh - kTremorLow) / kSines;
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < kSines; ++i) {
      // One frequency a slot, off the slot's edges: no two beat slower than every 4 s.
      const double hertz = kTremorLow + kSlot * (i + 0.2 + 0.6 * random.uniform());
      const double phase = 2.0 * std::numbers::pi * random.uniform();
      omega_(i, axis) = 2.0 * std::numbers::pi * hertz;
      sin_(i, axis) = std::sin(phase);
      cos_(i, axis) = std::cos(phase);
    }
  }
  turn_sin_.setZero();
  turn_cos_.setOnes();
  update();
}

void Tremor::step(double dt) noexcept {
  if (amplitude_ == 0.0) return;
  if (dt != turn_dt_) {
    turn_dt_ = dt;
    turn_sin_ = (omega_ * dt).sin();
    turn_cos_ = (omega_ * dt).cos();
  }
  const Sines s = sin_ * turn_cos_ + cos_ * turn_sin_;
  const Sines c = cos_ * turn_cos_ - sin_ * turn_sin_;
  // One Newton step back to unit length, so that rounding never adds up to a change of amplitude.
  const Sines length = 1.5 - 0.5 * (s * s + c * c);
  sin_ = length * s;
  cos_ = length * c;
  update();
}

void Tremor::update() noexcept {
  value_ = amplitude_ * sin_.colwise().sum().transpose().matrix();
  rate_ = amplitude_ * (omega_ * cos_).colwise().sum().transpose().matrix();
}

HandWander::HandWander(std::uint64_t seed, double tremor_rms, double drift_rms,
                       double drift_rotation_rms) noexcept
    : random_(seed), tremor_(tremor_rms, random_), drift_(drift_rms, drift_rotation_rms) {}

void HandWander::step(double dt) noexcept {
  tremor_.step(dt);
  drift_.step(dt, random_);
}

Vec3 HandWander::rotation() const noexcept {
  const Vec3& sideways = tremor_.value();
  return drift_.rotation() + Vec3(-sideways.y(), sideways.x(), 0.0) / kStylusLever;
}

}  // namespace handrail
