// Friction that grows as a screw is turned, (2.2).
#pragma once

#include <algorithm>
#include <cmath>

#include "server/effects/effect_input.h"
#include "server/effects/slider.h"

namespace handrail {

// f = -B_w x',  B_w = c alpha for alpha >= 0, else 0  (2.2).
//
// alpha is the angle turned about a centre, summed over the ticks in which the proxy is in a region
// that says progressive; turning the other way takes it back, below zero too: a screw turned out
// must come back before it is tight again. The force goes through a slider, so that it is exact at
// steady speed and stable at any c; leaving the region it fades within 50 ms.
class ProgressiveFriction {
 public:
  // Of c that is ordered, so that no hand on its way is stopped with a jerk: from the
  // dissertation's 5 to its 15 in half a second, our choice.
  static constexpr double kMostChange = 20.0;  // [N s/(m rad)] a second

  static constexpr EffectKind kKind = EffectKind::kProgressive;
  ProgressiveFriction(const EffectSpec& e, const Plant& plant) noexcept
      : ProgressiveFriction(e.c, e.at, e.clockwise, e.coupling, plant) {}
  ProgressiveFriction(double c, const Vec2& centre, bool clockwise, double coupling,
                      const Plant& plant) noexcept
      : c_(c), centre_(centre), sign_(clockwise ? -1.0 : 1.0) {
    law_.coupling = coupling;
    law_.yield = plant.most_force;
  }

  // Starts measuring anew from where the hand is; what has been turned so far stays.
  void restart(const Vec2& hand) noexcept {
    slider_.restart(hand);
    turning_ = false;
  }

  Vec2 force(const EffectInput& in, EffectTick& tick) noexcept {
    if (in.screw_c >= 0.0) {
      const double most = kMostChange * in.dt;
      c_ += std::clamp(in.screw_c - c_, -most, most);
    }
    const bool inside = in.region->progressive;
    if (inside) turn(in.proxy - centre_);
    if (!inside) turning_ = false;
    if (fade_.share() == 0.0) slider_.restart(in.hand);
    const double share = fade_.move(inside, in.dt);
    if (share == 0.0) return Vec2::Zero();
    law_.viscosity = alpha_ > 0.0 ? c_ * alpha_ : 0.0;
    const Vec2 f = slider_.force(in.hand, law_, in.dt);
    tick.by_spring(share * slider_.spring());
    return share * f;
  }

  double alpha() const noexcept { return alpha_; }                                // [rad]
  double c() const noexcept { return c_; }                                        // [N s/(m rad)]
  double viscosity() const noexcept { return alpha_ > 0.0 ? c_ * alpha_ : 0.0; }  // B_w [N s/m]
  double stiffness() const noexcept { return law_.coupling; }

 private:
  void turn(const Vec2& arm) noexcept {
    constexpr double kShortest = 1e-3;  // nearer the centre there is no angle [m]
    if (arm.squaredNorm() < kShortest * kShortest) {
      turning_ = false;
      return;
    }
    if (turning_) {
      const double cross = arm_.x() * arm.y() - arm_.y() * arm.x();
      // Kahan's sum: a day of turns, a tick each, adds up without rounding.
      const double by = sign_ * std::atan2(cross, arm_.dot(arm)) - carry_, before = alpha_;
      alpha_ = before + by;
      carry_ = (alpha_ - before) - by;
    }
    arm_ = arm;
    turning_ = true;
  }

  double c_;  // [N s/(m rad)]
  Vec2 centre_;
  double sign_;
  double alpha_ = 0.0;
  double carry_ = 0.0;       // that alpha_ has too much by rounding [rad]
  bool turning_ = false;     // arm_ is of the tick before
  Vec2 arm_ = Vec2::Zero();  // from the centre to the proxy [m]
  Fade fade_;
  SliderLaw law_;
  Slider slider_;
};

}  // namespace handrail
