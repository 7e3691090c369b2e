// The effects of a scene, as values in a list of fixed capacity.
#pragma once

#include <array>
#include <variant>
#include <vector>

#include "server/effects/coulomb_friction.h"
#include "server/effects/detent.h"
#include "server/effects/effect_input.h"
#include "server/effects/one_way_aisle.h"
#include "server/effects/progressive_friction.h"
#include "server/effects/return_spring.h"
#include "server/effects/viscous_aisle.h"
#include "server/effects/wall_spring.h"
#include "server/model/effect_list.h"

namespace handrail {

template <typename... Effects>
struct EffectTypes {};
// Every effect of the master's step. Each says which kind of a scene's list it is, and is made of
// that entry.
using AllEffects = EffectTypes<WallSpring, ViscousAisle, ProgressiveFriction, Detent, ReturnSpring,
                               CoulombFriction, OneWayAisle>;

template <typename T>
struct AnyOf;
template <typename... Effects>
struct AnyOf<EffectTypes<Effects...>> {
  using type = std::variant<std::monostate, Effects...>;
};

// Holds what the scene lists and nothing else. Real-time safe but for construction; copying is a
// plain copy.
class EffectStack {
 public:
  EffectStack() = default;
  // `specs` have passed the loader's checks: at most kMostEffects. What is of the simulated device
  // is left to it. May allocate.
  EffectStack(const std::vector<EffectSpec>& specs, const Plant& plant);

  // The hand is at `hand` after a jump of its frame: what effects remember of its place is dropped,
  // what they counted stays.
  void restart(const Vec2& hand) noexcept;

  // One tick. Bounded work; finite for finite input.
  EffectTick step(const EffectInput& in) noexcept;

  int size() const noexcept { return count_; }
  // Most that springs between hand and something at rest change the force per way of the hand, the
  // walls' own left out [N/m].
  double stiffness() const noexcept;

  // The effect of type T, or null where the scene lists none.
  template <typename T>
  const T* find() const noexcept {
    for (int i = 0; i < count_; ++i) {
      if (const T* found = std::get_if<T>(&effects_[static_cast<std::size_t>(i)])) return found;
    }
    return nullptr;
  }

 private:
  std::array<AnyOf<AllEffects>::type, kMostEffects> effects_{};
  int count_ = 0;
};

}  // namespace handrail
