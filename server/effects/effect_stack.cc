#include "server/effects/effect_stack.h"

#include <algorithm>
#include <type_traits>

namespace handrail {

EffectStack::EffectStack(const std::vector<EffectSpec>& specs, const Plant& plant) {
  std::vector<EffectSpec> sorted = specs;
  // A detent goes before the return spring, which asks whether it holds the hand.
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const EffectSpec& a, const EffectSpec& b) { return a.kind < b.kind; });
  for (const EffectSpec& e : sorted) {
    if (count_ == kMostEffects || is_of_device(e.kind)) break;
    Effect& effect = effects_[static_cast<std::size_t>(count_++)];
    switch (e.kind) {
      case EffectKind::kWall:
        effect = WallSpring(plant);
        break;
      case EffectKind::kViscous:
        effect = ViscousAisle(e.coupling, plant);
        break;
      case EffectKind::kProgressive:
        effect = ProgressiveFriction(e.c, e.at, e.clockwise, e.coupling, plant);
        break;
      case EffectKind::kDetent:
        effect = e.radii.empty() ? Detent(e.places, e.radius, e.peak)
                                 : Detent(e.places, e.radii, e.peaks);
        break;
      case EffectKind::kReturn:
        effect = ReturnSpring(e.at, e.stiffness, e.peak, e.radius);
        break;
      case EffectKind::kCoulomb:
        effect = CoulombFriction(e.peak, e.coupling);
        break;
      case EffectKind::kOneWay:
        effect = OneWayAisle(e.coupling, plant);
        break;
      default:
        break;
    }
  }
}

void EffectStack::restart(const Vec2& hand) noexcept {
  for (int i = 0; i < count_; ++i) {
    std::visit(
        [&hand](auto& effect) {
          if constexpr (!std::is_same_v<std::decay_t<decltype(effect)>, std::monostate>) {
            effect.restart(hand);
          }
        },
        effects_[static_cast<std::size_t>(i)]);
  }
}

EffectTick EffectStack::step(const EffectInput& in) noexcept {
  EffectTick tick;
  for (int i = 0; i < count_; ++i) {
    std::visit(
        [&](auto& effect) {
          if constexpr (!std::is_same_v<std::decay_t<decltype(effect)>, std::monostate>) {
            tick.force += effect.force(in, tick);
          }
        },
        effects_[static_cast<std::size_t>(i)]);
  }
  return tick;
}

double EffectStack::stiffness() const noexcept {
  double sum = 0.0;
  for (int i = 0; i < count_; ++i) {
    std::visit(
        [&sum](const auto& effect) {
          if constexpr (requires { effect.stiffness(); }) sum += effect.stiffness();
        },
        effects_[static_cast<std::size_t>(i)]);
  }
  return sum;
}

}  // namespace handrail
