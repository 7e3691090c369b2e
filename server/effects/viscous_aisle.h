// Drag of the region the hand is in.
#pragma once

#include <algorithm>

#include "server/effects/effect_input.h"
#include "server/effects/slider.h"

namespace handrail {

// f = -B x' with B the region's viscosity (dissertation 2.2.1, Fig. 2.2b), through a slider, so
// that any B is stable. From region to region B changes within about 20 ms.
class ViscousAisle {
 public:
  static constexpr EffectKind kKind = EffectKind::kViscous;
  ViscousAisle(const EffectSpec& e, const Plant& plant) noexcept
      : ViscousAisle(e.coupling, plant) {}
  ViscousAisle(double coupling, const Plant& plant) noexcept {
    law_.coupling = coupling;
    law_.yield = plant.most_force;
  }

  void restart(const Vec2& hand) noexcept { slider_.restart(hand); }

  Vec2 force(const EffectInput& in, EffectTick& tick) noexcept {
    constexpr double kNothing = 1e-3;  // [N s/m]
    if (law_.viscosity == 0.0) slider_.restart(in.hand);
    law_.viscosity += changed_in(in.dt) * (in.region->viscosity - law_.viscosity);
    if (law_.viscosity < kNothing) {
      law_.viscosity = 0.0;
      return Vec2::Zero();
    }
    Vec2 f = slider_.force(in.hand, law_, in.dt);
    tick.by_spring(slider_.spring());
    return f;
  }

  double stiffness() const noexcept { return law_.coupling; }

 private:
  SliderLaw law_;
  Slider slider_;
};

}  // namespace handrail
