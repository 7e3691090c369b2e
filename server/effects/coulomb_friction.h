// Dry friction.
#pragma once

#include <limits>

#include "server/effects/effect_input.h"
#include "server/effects/slider.h"

namespace handrail {

// |f| <= F against the motion, F while it lasts: an elasto-plastic slider (Hayward and Armstrong
// 2000). At rest it holds without creeping or chattering; it needs no velocity.
class CoulombFriction {
 public:
  static constexpr EffectKind kKind = EffectKind::kCoulomb;
  CoulombFriction(const EffectSpec& e, const Plant&) noexcept
      : CoulombFriction(e.peak, e.coupling) {}
  CoulombFriction(double force, double coupling) noexcept {
    law_ = {coupling, std::numeric_limits<double>::infinity(), force};
  }

  void restart(const Vec2& hand) noexcept {
    slider_.restart(hand);
    known_ = true;
  }

  Vec2 force(const EffectInput& in, EffectTick& tick) noexcept {
    if (!known_) restart(in.hand);
    Vec2 f = slider_.force(in.hand, law_, in.dt);
    tick.by_spring(slider_.spring());
    return f;
  }

  double stiffness() const noexcept { return law_.coupling; }

 private:
  SliderLaw law_;
  Slider slider_;
  bool known_ = false;
};

}  // namespace handrail
