#include "devices/joystick/sim_joystick.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace handrail {
namespace {

constexpr double kStopMargin = 0.002;    // beyond the nominal work space [m]
constexpr double kStopStiffness = 20e3;  // [N/m]
constexpr double kStopDamping = 50.0;    // [N s/m]
constexpr double kAcross = 1e3;          // the plane has no stops across it [m]
constexpr Nanos kLongestAdvance = kSecond;

HeldBody joystick_body(const DeviceEffects& effects) noexcept {
  HeldBody body;
  body.mass = effects.inertia ? kJoystickMass : 0.0;
  body.friction = effects.friction ? kJoystickFriction : 0.0;
  body.viscosity = effects.friction ? kJoystickViscosity : 0.0;
  const double stop = kJoystickHalf + kStopMargin;
  body.stop_half = Vec3(stop, stop, kAcross);
  body.stop_stiffness = kStopStiffness;
  body.stop_damping = kStopDamping;
  return body;
}

// The same motion within the plane.
VectorMotion flat(VectorMotion motion) noexcept {
  motion.p.z() = motion.v.z() = motion.a.z() = 0.0;
  return motion;
}

}  // namespace

SimJoystick::SimJoystick(const HandOptions& hand, const DeviceEffects& effects,
                         std::optional<RecordedMotion> recording)
    : capabilities_(joystick_capabilities()),
      effects_(effects),
      hand_(hand, joystick_body(effects)),
      recording_(std::move(recording)) {}

Status SimJoystick::open() {
  open_ = true;
  started_ = false;
  wrench_ = Wrench{};
  if (recording_) {
    // The hand waits where the recording begins.
    played_ = 0.0;
    hand_.place(flat(recording_->motion_at(0.0)).p);
  }
  return Status::ok();
}

void SimJoystick::simulate(const DeviceEffects& effects, const Vec3& home_M) noexcept {
  effects_ = effects;
  hand_.hold(joystick_body(effects));
  const Vec3 home(home_M.x(), home_M.y(), 0.0);
  hand_.set_home(home);
  if (recording_) return;  // plays on
  if (!started_) return hand_.place(home);
  HandIntent intent;
  intent.home = true;
  steer(intent);
}

void SimJoystick::steer(const HandIntent& intent) noexcept {
  HandIntent in_plane = intent;
  in_plane.displacement_M.z() = 0.0;
  in_plane.rotation_M.setZero();
  mode_ = Mode::kSteered;
  hand_.steer(in_plane);
}

void SimJoystick::follow(const Vec2& p, const Vec2& v) noexcept {
  if (!p.allFinite() || !v.allFinite()) return;
  if (mode_ != Mode::kFollowing) pursuit_.start(hand_.motion().position());
  mode_ = Mode::kFollowing;
  target_.p = Vec3(p.x(), p.y(), 0.0);
  target_.v = Vec3(v.x(), v.y(), 0.0);
}

void SimJoystick::let_go() noexcept { mode_ = Mode::kLimp; }

HapticSample SimJoystick::read(Nanos now) noexcept {
  if (!open_) return {};
  if (!started_) {
    started_ = true;
    last_ = now;
    sample_.X_MH.p = reading();
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
    advance(to_seconds(part));
    impulse += to_seconds(part) * hand_.push();
    observe(to_seconds(part));
    left -= part;
  }
  push_ = impulse / passed;
  return sample_;
}

void SimJoystick::advance(double dt) noexcept {
  if (recording_) {
    played_ += dt;
    hand_.lead(flat(recording_->motion_at(played_)));
  } else if (mode_ == Mode::kLimp) {
    hand_.lead(flat(hand_.given_way(dt)));
  } else if (mode_ == Mode::kFollowing) {
    target_.p += dt * target_.v;  // until the next call
    VectorMotion now;
    now.p = hand_.pose().p;
    now.v = hand_.velocity();
    hand_.lead(flat(pursuit_.step(target_, flat(now), dt)));
  }
  hand_.step(dt, wrench_);
}

Vec3 SimJoystick::reading() const noexcept {
  Vec3 p = hand_.pose().p;
  p.z() = 0.0;
  if (!effects_.quantisation) return p;
  return kJoystickResolution * (p / kJoystickResolution).array().round().matrix();
}

void SimJoystick::observe(double dt) noexcept {
  const Vec3 p = reading();
  sample_.v_MH = joystick_velocity(sample_.v_MH, sample_.X_MH.p, p, dt);
  sample_.X_MH.p = p;
  sample_.buttons = hand_.buttons();
}

void SimJoystick::write(const Wrench& f_H_M) noexcept {
  wrench_ = Wrench{};
  unrenewed_ = 0;
  if (!is_finite(f_H_M)) return;
  Vec3 force(f_H_M.force.x(), f_H_M.force.y(), 0.0);
  // Beyond any motor's reach even where the limits are not simulated.
  const double most = effects_.force_limits ? capabilities_.max_force : 1e3;
  if (force.squaredNorm() > most * most) force *= most / force.stableNorm();
  wrench_.force = force;
}

void SimJoystick::close() noexcept {
  wrench_ = Wrench{};
  open_ = false;
}

}  // namespace handrail
