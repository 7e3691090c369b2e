#include "server/haptic/arbiter.h"

#include <algorithm>
#include <cmath>

namespace handrail {
namespace {

// Finite, and small enough to be squared.
bool usable(const Vec3& f) { return is_finite(f) && f.cwiseAbs().maxCoeff() < 1e9; }

// Largest s in 0..1 with |a + s b| <= cap, for |a| <= cap.
double largest_share(const Vec3& a, const Vec3& b, double cap) {
  const double bb = b.squaredNorm();
  if ((a + b).squaredNorm() <= cap * cap || bb == 0.0) return 1.0;
  const double ab = a.dot(b);
  const double room = std::max(cap * cap - a.squaredNorm(), 0.0);
  return std::clamp((std::sqrt(ab * ab + bb * room) - ab) / bb, 0.0, 1.0);
}

// The peak falls from full to the continuous force as the heat nears what can be sustained: from
// 70 % of it on, linearly, so that the force never steps.
double peak_now(const ForceLimits& limits, double heat) {
  const double sustained = limits.continuous * limits.continuous;
  if (sustained <= 0.0) return limits.peak;  // a device without force has nothing to heat
  const double excess = std::clamp((heat / sustained - 0.7) / 0.3, 0.0, 1.0);
  return limits.peak - excess * (limits.peak - limits.continuous);
}

}  // namespace

ForceShares Arbiter::share(const ForceLimits& limits, Vec3 f_tool, Vec3 f_spring,
                           double hand_allowance, Trust trust, double dt) noexcept {
  ForceShares out;
  if (trust == Trust::kNone) hand_allowance = 0.0;
  if (trust == Trust::kNone || !usable(f_tool)) f_tool.setZero();
  if (trust != Trust::kBoth || !usable(f_spring)) f_spring.setZero();

  const double cap = peak_now(limits, heat_);
  const double wanted = f_tool.norm();
  Vec3 tool = f_tool;
  if (wanted > cap) {
    tool *= cap / wanted;
    (cap < limits.peak ? out.thermal : out.clamped) = true;
  }
  out.peak_took = tool - f_tool;
  const double s = largest_share(tool, f_spring, cap);
  // Without a tool nothing is kept for one: the device's limit alone takes.
  out.budget = s < 1.0 && wanted > 0.0;
  if (s < 1.0 && cap < limits.peak) out.thermal = true;
  if (s < 1.0 && !out.budget && !out.thermal) out.clamped = true;
  out.tool = tool;
  out.spring = s * f_spring;
  Vec3 force = out.tool + out.spring;

  const Vec3 change = force - last_;
  const double allowed =
      hand_allowance +
      (trust == Trust::kBoth ? limits.step * dt * 1e3 : limits.peak * dt / limits.fade_out);
  if (change.norm() > allowed) {
    force = last_ + change * (allowed / change.norm());
    out.stepped = true;
  }
  // The device's own limit comes last, whatever went before; then the finite check.
  const double size = force.norm();
  if (size > limits.peak) {
    out.peak_took += force * (limits.peak / size - 1.0);
    force *= limits.peak / size;
  }
  if (!is_finite(force)) force.setZero();
  last_ = out.device = force;
  heat_ += (out.device.squaredNorm() - heat_) * std::min(dt / limits.thermal_time, 1.0);
  out.limited = out.device - out.tool - out.spring;
  return out;
}

}  // namespace handrail
