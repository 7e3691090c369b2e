#include "devices/omni/sim_omni.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace handrail {
namespace {

constexpr double kStopMargin = 0.010;    // beyond the nominal work space [m]
constexpr double kStopStiffness = 10e3;  // [N/m]; keeps an arm's push within a few mm
constexpr double kStopDamping = 20.0;    // [N s/m]
constexpr Nanos kLongestAdvance = kSecond;

HeldBody omni_body() noexcept {
  HeldBody body;
  body.mass = kOmniMass;
  body.friction = kOmniFriction;
  body.inertia = kOmniInertia;
  body.turn_viscosity = kOmniTurnDamping;
  body.stop_half = omni_workspace_half() + Vec3::Constant(kStopMargin);
  body.stop_stiffness = kStopStiffness;
  body.stop_damping = kStopDamping;
  return body;
}

Vec3 limited(const Vec3& v, double limit) noexcept {
  if (v.squaredNorm() <= limit * limit) return v;
  return v * (limit / v.stableNorm());
}

Vec3 quantised(const Vec3& p) noexcept {
  return kOmniResolution * (p / kOmniResolution).array().round().matrix();
}

}  // namespace

SimOmni::SimOmni(const HandOptions& hand, bool torque) noexcept
    : capabilities_(omni_capabilities(torque)), hand_(hand, omni_body()) {}

Status SimOmni::open() {
  open_ = true;
  started_ = false;
  wrench_ = Wrench{};
  return Status::ok();
}

HapticSample SimOmni::read(Nanos now) noexcept {
  if (!open_) return {};
  if (!started_) {
    started_ = true;
    last_ = now;
    sample_.X_MH = hand_.pose();
    sample_.X_MH.p = quantised(sample_.X_MH.p);
    sample_.v_MH = Vec3::Zero();
    sample_.buttons = hand_.buttons();
    sample_.valid = true;
    return sample_;
  }
  if (now <= last_) return sample_;
  Nanos left = std::min(now - last_, kLongestAdvance);
  const double passed = to_seconds(left);
  Vec3 impulse = Vec3::Zero();  // of the hand [N s]
  last_ = now;
  while (left > 0) {
    const Nanos part = std::min(left, kMillisecond);
    if (unrenewed_ >= kForceStands) wrench_ = Wrench{};
    unrenewed_ += part;
    hand_.step(to_seconds(part), wrench_);
    impulse += to_seconds(part) * hand_.push();
    observe(to_seconds(part));
    left -= part;
  }
  push_ = impulse / passed;
  return sample_;
}

// It has all of its effects always.
void SimOmni::simulate(const DeviceEffects&, const Vec3& home_M) noexcept {
  hand_.set_home(home_M);
  if (!started_) return hand_.place(home_M);
  HandIntent home;
  home.home = true;
  hand_.steer(home);
}

void SimOmni::observe(double dt) noexcept {
  Pose pose = hand_.pose();
  pose.p = quantised(pose.p);
  const double follow = -std::expm1(-2.0 * std::numbers::pi * kOmniVelocityCutoff * dt);
  sample_.v_MH += follow * ((pose.p - sample_.X_MH.p) / dt - sample_.v_MH);
  sample_.X_MH = pose;
  sample_.buttons = hand_.buttons();
}

void SimOmni::write(const Wrench& f_H_M) noexcept {
  wrench_ = Wrench{};
  unrenewed_ = 0;
  if (!is_finite(f_H_M)) return;
  wrench_.force = limited(f_H_M.force, capabilities_.max_force);
  wrench_.torque = limited(f_H_M.torque, capabilities_.max_torque);
}

void SimOmni::close() noexcept {
  wrench_ = Wrench{};
  open_ = false;
}

}  // namespace handrail
