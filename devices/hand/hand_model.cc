#include "devices/hand/hand_model.h"

#include <algorithm>
#include <cmath>

namespace handrail {
namespace {

constexpr double kInnerStep = 0.25e-3;  // [s]
constexpr double kSlow = 1e-3;          // below this the expected friction fades out [m/s]

// How fast a limp hand gives way, and its muscles' lag, as in pursuit [s]. Our choice: with every
// hand of joystick_grip, and 0.5 to 1.5 kg of it, hand and joystick then give back no energy at any
// frequency.
constexpr double kGiveWay = 0.2;
constexpr double kMuscleLag = 0.08;

}  // namespace

HandModel::HandModel(const HandOptions& options, const HeldBody& held) noexcept
    : held_(held),
      mass_(options.mass + held.mass),
      hand_mass_(options.mass),
      stiffness_(options.stiffness),
      hand_damping_(2.0 * options.damping_ratio * std::sqrt(options.stiffness * options.mass)),
      damping_(hand_damping_ + held.viscosity),
      wander_is_meant_(options.wander_is_meant),
      turn_lever_(options.turn_lever),
      hand_inertia_(options.rotation_inertia),
      inertia_(hand_inertia_ + held.inertia),
      rotation_stiffness_(options.rotation_stiffness),
      hand_turn_damping_(2.0 * options.rotation_damping_ratio *
                         std::sqrt(options.rotation_stiffness * options.rotation_inertia)),
      rotation_damping_(hand_turn_damping_ + held.turn_viscosity),
      motion_(options.reaction),
      wander_(options.seed, options.tremor_rms, options.drift_rms, options.drift_rotation_rms) {}

void HandModel::place(const Vec3& p) noexcept {
  motion_.lead({p, Vec3::Zero(), Vec3::Zero()});
  x_ = p;
  v_ = meant_rate_ = deviation_ = deviation_rate_ = Vec3::Zero();
}

void HandModel::hold(const HeldBody& held) noexcept {
  held_ = held;
  mass_ = hand_mass_ + held.mass;
  damping_ = hand_damping_ + held.viscosity;
  inertia_ = hand_inertia_ + held.inertia;
  rotation_damping_ = hand_turn_damping_ + held.turn_viscosity;
}

void HandModel::step(double dt, const Wrench& f_H_M) noexcept {
  const int steps = std::max(1, static_cast<int>(std::ceil(dt / kInnerStep - 1e-6)));
  const double h = dt / steps;
  const Vec3 v_before = v_;
  effort_.setZero();
  for (int i = 0; i < steps; ++i) {
    motion_.step(h);
    translate(h, f_H_M.force);
    rotate(h, f_H_M.torque);
  }
  const Vec3 meant_rate = meant().v;
  push_ = (effort_ + mass_ * (meant_rate - meant_rate_) - hand_mass_ * (v_ - v_before)) / dt;
  meant_rate_ = meant_rate;
  wander_.step(dt);
}

// r' goes to e / kGiveWay within the muscles' lag, e being the deviation from what is meant.
VectorMotion HandModel::given_way(double dt) const noexcept {
  VectorMotion intent = motion_.position();
  const Vec3 before = intent.v, wanted = deviation_ / kGiveWay;
  intent.v = wanted + std::exp(-dt / kMuscleLag) * (before - wanted);
  intent.p += dt * intent.v;
  intent.a = (intent.v - before) / dt;
  return intent;
}

VectorMotion HandModel::meant() const noexcept {
  VectorMotion out = motion_.position();
  if (!wander_is_meant_) return out;
  out.p += wander_.position();
  out.v += wander_.velocity();
  return out;
}

void HandModel::translate(double h, const Vec3& force) noexcept {
  const VectorMotion intent = meant();
  const Vec3& r = intent.p;
  const Vec3& r_rate = intent.v;
  const Vec3 expected_friction = held_.friction / std::max(r_rate.norm(), kSlow) * r_rate;
  const double resistance = mass_ + h * (damping_ + h * stiffness_);
  const Vec3 push = force + stop_force() + expected_friction - stiffness_ * deviation_;
  const Vec3 free_rate = (mass_ * deviation_rate_ + h * push) / resistance;

  const Vec3 v_free = r_rate + free_rate;
  const double speed = v_free.norm();
  const double lost = h * held_.friction / resistance;
  if (speed <= lost) {
    v_ = Vec3::Zero();
    deviation_rate_ = -r_rate;
    deviation_ = x_ - r;
  } else {
    v_ = (1.0 - lost / speed) * v_free;
    deviation_rate_ = v_ - r_rate;
    deviation_ += h * deviation_rate_;
    x_ = r + deviation_;
  }
  effort_ += h * (expected_friction + held_.viscosity * r_rate - stiffness_ * deviation_ -
                  hand_damping_ * deviation_rate_);
}

void HandModel::rotate(double h, const Vec3& torque) noexcept {
  const double resistance = inertia_ + h * (rotation_damping_ + h * rotation_stiffness_);
  turn_rate_ = (inertia_ * turn_rate_ + h * (torque - rotation_stiffness_ * turn_)) / resistance;
  turn_ += h * turn_rate_;
}

Vec3 HandModel::stop_force() const noexcept {
  Vec3 f = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    const double side = x_[i] < 0.0 ? -1.0 : 1.0;
    const double depth = side * x_[i] - held_.stop_half[i];
    if (depth <= 0.0) continue;
    f[i] = -side * std::max(0.0, held_.stop_stiffness * depth + held_.stop_damping * side * v_[i]);
  }
  return f;
}

Vec3 HandModel::strayed() const noexcept {
  const Vec3 from_tip_to_grip(0.0, std::sqrt(0.5), std::sqrt(0.5));
  return turn_lever_ * (motion_.orientation() * from_tip_to_grip - from_tip_to_grip);
}

Pose HandModel::pose() const noexcept {
  const Quat away = rotation_exp(turn_) * rotation_exp(wander_.rotation());
  const Vec3 shaken = wander_is_meant_ ? Vec3(Vec3::Zero()) : wander_.position();
  return {x_ + strayed() + shaken, (away * motion_.orientation()).normalized()};
}

}  // namespace handrail
