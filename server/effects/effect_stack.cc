#include "server/effects/effect_stack.h"

#include <algorithm>
#include <type_traits>

namespace handrail {
namespace {

template <typename... Effects>
std::variant<std::monostate, Effects...> make(const EffectSpec& spec, const Plant& plant,
                                              EffectTypes<Effects...>) {
  std::variant<std::monostate, Effects...> out;
  (void)((Effects::kKind == spec.kind && (out = Effects(spec, plant), true)) || ...);
  return out;
}

}  // namespace

EffectStack::EffectStack(const std::vector<EffectSpec>& specs, const Plant& plant) {
  std::vector<EffectSpec> sorted = specs;
  // A detent goes before the return spring, which asks whether it holds the hand.
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const EffectSpec& a, const EffectSpec& b) { return a.kind < b.kind; });
  for (const EffectSpec& e : sorted) {
    if (count_ == kMostEffects || is_of_device(e.kind)) break;
    effects_[static_cast<std::size_t>(count_++)] = make(e, plant, AllEffects());
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
