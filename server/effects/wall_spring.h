// Spring and damper of a wall, (2.1).
#pragma once

#include <algorithm>

#include "server/effects/effect_input.h"

namespace handrail {

// f = K (x_proxy - x) - B x'  (2.1), of the wall that is touched.
//
// Read as a wall: the damper acts along the way out only, comes on over the first half millimetre
// (after Hunt and Crossley 1975), so that the force of contact begins at zero, and never pulls the
// hand in. B is kept under what a force held for a period can do, B / (1 + B h / m), with h the
// period and the velocity's lag and m the least mass: over a tick the damper can stop the hand but
// not throw it back, whatever B. Where the wall's stiffness or damping changes, along it or with a
// stage, the change is spread over 20 ms. Or the damper is that of (2.1) to the letter: against all
// of the motion, from the first touch on, and as large as it is written, though it may be unstable.
class WallSpring {
 public:
  static constexpr EffectKind kKind = EffectKind::kWall;
  WallSpring(const EffectSpec& e, const Plant& plant) noexcept
      : plant_(plant), published_damper_(e.published_damper) {}
  explicit WallSpring(const Plant& plant) noexcept : plant_(plant) {}

  void restart(const Vec2&) noexcept { stiffness_ = 0.0; }

  Vec2 force(const EffectInput& in, EffectTick& tick) noexcept {
    if (in.wall == nullptr) {
      stiffness_ = 0.0;
      return Vec2::Zero();
    }
    constexpr double kOnset = 0.5e-3;  // [m]
    if (stiffness_ == 0.0) {
      stiffness_ = in.wall->stiffness;
      damping_ = in.wall->damping;
    }
    stiffness_ += changed_in(in.dt) * (in.wall->stiffness - stiffness_);
    damping_ += changed_in(in.dt) * (in.wall->damping - damping_);
    const Vec2 out = in.proxy - in.hand;
    Vec2 spring = stiffness_ * out;
    tick.by_spring(spring, stiffness_);
    if (published_damper_) return spring - damping_ * in.velocity;
    const double depth = out.norm();
    if (damping_ == 0.0 || depth == 0.0) return spring;
    const double damping =
        damping_ / (1.0 + damping_ * (in.dt + plant_.velocity_lag) / plant_.least_mass);
    const double speed_out = in.velocity.dot(out) / depth;
    const double drag = damping * std::min(depth / kOnset, 1.0) * speed_out;
    return (std::max(stiffness_ * depth - drag, 0.0) / depth) * out;
  }

 private:
  Plant plant_;
  bool published_damper_ = false;
  double stiffness_ = 0.0;  // in force; 0: nothing touched [N/m]
  double damping_ = 0.0;    // in force [N s/m]
};

}  // namespace handrail
