// Aisles that can be passed in one direction only.
#pragma once

#include <algorithm>

#include "server/effects/effect_input.h"

namespace handrail {

// In a region with a direction d, the furthest travel so far, t* = max x.d, holds the hand like a
// pawl: f = (K (t* - x.d) - b (x.d)') d, never along -d, with b = 3/4 K T for the half period by
// which a held spring force is late. The pawl slips where the force would pass the device's most.
// Leaving the region the force fades within 50 ms; coming back, the travel counts anew.
class OneWayAisle {
 public:
  static constexpr EffectKind kKind = EffectKind::kOneWay;
  OneWayAisle(const EffectSpec& e, const Plant& plant) noexcept : OneWayAisle(e.stiffness, plant) {}
  OneWayAisle(double stiffness, const Plant& plant) noexcept
      : stiffness_(stiffness), most_force_(plant.most_force) {}

  void restart(const Vec2&) noexcept { region_ = nullptr; }

  Vec2 force(const EffectInput& in, EffectTick& tick) noexcept {
    const bool inside = in.region->one_way.squaredNorm() > 0.0;
    if (inside && (in.region != region_)) {
      region_ = in.region;
      direction_ = region_->one_way;
      furthest_ = last_ = in.hand.dot(direction_);
    }
    if (!inside) region_ = nullptr;
    const double share = fade_.move(inside, in.dt);
    if (share == 0.0) return Vec2::Zero();
    const double travel = in.hand.dot(direction_);
    const double rate = (travel - last_) / in.dt;
    last_ = travel;
    furthest_ = std::max(furthest_, travel);
    furthest_ = std::min(furthest_, travel + most_force_ / stiffness_);
    if (furthest_ == travel) return Vec2::Zero();
    const double spring = std::min(stiffness_ * (furthest_ - travel), most_force_);
    tick.by_spring(share * spring * direction_);
    const double push = stiffness_ * (furthest_ - travel) - 0.75 * stiffness_ * in.dt * rate;
    return (share * std::clamp(push, 0.0, most_force_)) * direction_;
  }

  double stiffness() const noexcept { return stiffness_; }

 private:
  double stiffness_;                    // [N/m]
  double most_force_;                   // [N]
  const WallRegion* region_ = nullptr;  // the hand is in; null: in none with a direction
  Vec2 direction_ = Vec2::Zero();       // unit
  double furthest_ = 0.0;               // [m]
  double last_ = 0.0;                   // travel a tick before [m]
  Fade fade_;
};

}  // namespace handrail
