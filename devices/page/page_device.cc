#include "devices/page/page_device.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "devices/page/page_data.h"

namespace handrail {
namespace {

constexpr double kPageStopMargin = 0.002;    // beyond the work space [m]
constexpr double kPageStopStiffness = 20e3;  // as the joystick's [N/m]
constexpr double kPageStopDamping = 50.0;    // [N s/m]
constexpr Nanos kLongestPageAdvance = kSecond;
constexpr std::uint32_t kDeadMan = 4;  // bit of the third button

HeldBody page_body() noexcept {
  HeldBody body;
  body.mass = kPageMass;
  body.friction = kPageFriction;
  body.viscosity = kPageViscosity;
  body.stop_half = Vec3::Constant(kPageHalf + kPageStopMargin);
  body.stop_stiffness = kPageStopStiffness;
  body.stop_damping = kPageStopDamping;
  return body;
}

}  // namespace

PageDevice::PageDevice(const HandOptions& hand) noexcept
    : capabilities_(page_capabilities()), hand_(hand, page_body()) {}

Status PageDevice::open() {
  open_ = true;
  started_ = false;
  wrench_ = Wrench{};
  return Status::ok();
}

// It has all of its effects always.
void PageDevice::simulate(const DeviceEffects&, const Vec3& home_M) noexcept {
  hand_.set_home(home_M);
  if (!started_) return hand_.place(home_M);
  HandIntent home;
  home.home = true;
  steer(home);
}

void PageDevice::steer(const HandIntent& intent) noexcept {
  led_ = false;
  hand_.steer(intent);
}

void PageDevice::lead(const CursorSample& cursor) noexcept {
  if (!is_finite(cursor.X_MC) || !is_unit(cursor.X_MC.q)) return;
  cursor_ = cursor;
  cursor_.X_MC.p = cursor.X_MC.p.cwiseMax(-kPageHalf).cwiseMin(kPageHalf);
  if (led_) return;
  led_ = true;
  intent_ = hand_.motion().position();
  halfway_ = intent_.p;
}

HapticSample PageDevice::read(Nanos now) noexcept {
  if (!open_) return {};
  if (!started_) {
    started_ = true;
    last_ = now;
    unrenewed_ = 0;
    sample_ = HapticSample();
    sample_.X_MH.p = hand_.pose().p;
    sample_.valid = true;
    return sample_;
  }
  if (now <= last_) return sample_;
  Nanos left = std::min(now - last_, kLongestPageAdvance);
  const double passed = to_seconds(left);
  Vec3 impulse = Vec3::Zero();  // of the hand [N s]
  last_ = now;
  while (left > 0) {
    const Nanos part = std::min(left, kMillisecond);
    if (unrenewed_ >= kForceStands) wrench_ = Wrench{};
    unrenewed_ += part;
    left -= part;
    advance(now - left, to_seconds(part));
    impulse += to_seconds(part) * hand_.push();
    observe(to_seconds(part));
  }
  push_ = impulse / passed;
  return sample_;
}

void PageDevice::advance(Nanos now, double dt) noexcept {
  const bool was_fresh = std::exchange(fresh_, led_ && now - cursor_.at <= kCursorPatience);
  buttons_ = fresh_ ? cursor_.buttons : hand_.buttons() & ~kDeadMan;
  if (fresh_) {
    const double share = -std::expm1(-dt / kPageSmoothing);
    halfway_ += share * (cursor_.X_MC.p - halfway_);
    const Vec3 before = intent_.v;
    intent_.v = (halfway_ - intent_.p) / kPageSmoothing;
    intent_.a = (intent_.v - before) / dt;
    intent_.p += share * (halfway_ - intent_.p);
    hand_.lead(intent_);
    turned_ = turned_.slerp(share, cursor_.X_MC.q).normalized();
  } else if (led_) {
    // Nobody pushes from now on.
    if (was_fresh) hand_.place(hand_.pose().p);
    intent_ = hand_.given_way(dt);
    halfway_ = intent_.p + kPageSmoothing * intent_.v;
    hand_.lead(intent_);
  }
  hand_.step(dt, wrench_);
}

void PageDevice::observe(double dt) noexcept {
  const Pose pose = hand_.pose();
  const double follow = -std::expm1(-2.0 * std::numbers::pi * kPageVelocityCutoff * dt);
  sample_.v_MH += follow * ((pose.p - sample_.X_MH.p) / dt - sample_.v_MH);
  sample_.X_MH.p = pose.p;
  sample_.X_MH.q = (pose.q * turned_).normalized();
  sample_.buttons = buttons_;
}

void PageDevice::write(const Wrench& f_H_M) noexcept {
  wrench_ = Wrench{};
  unrenewed_ = 0;
  if (!is_finite(f_H_M)) return;
  wrench_.force = f_H_M.force;
  if (wrench_.force.squaredNorm() > kPageForce * kPageForce) {
    wrench_.force *= kPageForce / wrench_.force.stableNorm();
  }
}

void PageDevice::close() noexcept {
  wrench_ = Wrench{};
  open_ = false;
}

}  // namespace handrail
