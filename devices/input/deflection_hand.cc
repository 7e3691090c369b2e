#include "devices/input/deflection_hand.h"

#include <algorithm>
#include <cmath>

namespace handrail {
namespace {

// Events come 8 to 16 ms apart (USB polling of such devices): two lags of the longer time, as the
// page's cursor has [s].
constexpr double kDeflectionSmoothing = 0.016;
// In which a free hand is back in the middle but for a third; our choice [s].
constexpr double kRecentring = 0.15;
// A step is made in parts as long as a tick: the same motion, however late a reading is [s].
constexpr double kLongestPart = 1e-3;
// So that the work stays bounded, as the simulated devices do [s].
constexpr double kLongestStep = 1.0;

Vec3 in_shares(const Vec3& v) noexcept {
  if (!is_finite(v)) return Vec3::Zero();
  return v.cwiseMax(-1.0).cwiseMin(1.0);
}

}  // namespace

HapticCapabilities deflection_capabilities(const DeflectionSettings& settings) {
  HapticCapabilities c;
  const bool turns =
      (settings.mode == DeflectionMode::kVelocity ? settings.turn_rate : settings.tilt) > 0.0;
  c.senses_rotation = turns;
  c.dynamics.source = "none: it makes no force";
  c.workspace_half = Vec3::Constant(settings.reach);
  return c;
}

void DeflectionHand::reset() noexcept {
  pose_ = Pose();
  smooth_ = Deflection();
  halt();
}

void DeflectionHand::halt() noexcept {
  if (settings_.mode == DeflectionMode::kVelocity) smooth_ = Deflection();
  halfway_ = smooth_;
  velocity_.setZero();
}

void DeflectionHand::step(const Deflection& deflection, bool recentre, double dt) noexcept {
  Deflection pushed{in_shares(deflection.move), in_shares(deflection.turn)};
  const bool to_middle = recentre && settings_.mode == DeflectionMode::kVelocity;
  if (to_middle) pushed = Deflection();
  double left = std::clamp(dt, 0.0, kLongestStep);
  while (left > 0.0) {
    const double now = std::min(left, kLongestPart);
    part(pushed, to_middle, now);
    left -= now;
  }
}

void DeflectionHand::part(const Deflection& pushed, bool recentre, double dt) noexcept {
  const double share = -std::expm1(-dt / kDeflectionSmoothing);
  halfway_.move += share * (pushed.move - halfway_.move);
  halfway_.turn += share * (pushed.turn - halfway_.turn);
  const Vec3 before = pose_.p;
  smooth_.move += share * (halfway_.move - smooth_.move);
  smooth_.turn += share * (halfway_.turn - smooth_.turn);
  if (settings_.mode == DeflectionMode::kPosition) {
    pose_.p = settings_.reach * smooth_.move;
    pose_.q = rotation_exp(settings_.tilt * smooth_.turn);
  } else {
    pose_.p += settings_.speed * dt * smooth_.move;
    if (recentre) pose_.p *= std::exp(-dt / kRecentring);
    pose_.p = pose_.p.cwiseMax(-settings_.reach).cwiseMin(settings_.reach);
    pose_.q = (rotation_exp(settings_.turn_rate * dt * smooth_.turn) * pose_.q).normalized();
  }
  velocity_ = (pose_.p - before) / dt;
}

}  // namespace handrail
