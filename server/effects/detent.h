// Places that pull the hand in and lock it, as the gears of a gearshift.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "server/effects/effect_input.h"
#include "server/scene/effect_list.h"

namespace handrail {

// Toward the place, at distance d of a radius r: f = F d / (r/2) up to r/2, F (r - d) / (r/2) from
// there to r, nothing beyond (dissertation 2.3.2, the locking of a gear; the shape is ours). The
// pull has a potential, F r / 2 deep, so that it gives back what it took; a small damper makes up
// for the half period by which a held force is late.
//
// The lock closes within r/2 and opens beyond r, both of the proxy: a hand that presses a lever
// past its gear, into the wall at the aisle's end, is still in gear.
class Detent {
 public:
  // 1 to kMostDetents places, further apart than 2 r; r and peak > 0.
  Detent(const std::vector<Vec2>& places, double radius, double peak) noexcept
      : radius_(radius), peak_(peak) {
    for (const Vec2& place : places) {
      if (count_ < kMostDetents) places_[static_cast<std::size_t>(count_++)] = place;
    }
  }

  void restart(const Vec2&) noexcept {}

  Vec2 force(const EffectInput& in, EffectTick& tick) noexcept {
    move_lock(in.proxy, tick);
    tick.locked = locked_ >= 0;
    for (int i = 0; i < count_; ++i) {
      const Vec2 back = places_[static_cast<std::size_t>(i)] - in.hand;
      const double d2 = back.squaredNorm();
      if (d2 >= radius_ * radius_) continue;
      const double d = std::sqrt(d2);
      const double slope = peak_ / (0.5 * radius_);
      const Vec2 f =
          d <= 0.5 * radius_ ? Vec2(slope * back) : Vec2((slope * (radius_ - d) / d) * back);
      return f - (0.75 * slope * in.dt * (1.0 - d / radius_)) * in.velocity;
    }
    return Vec2::Zero();
  }

  int locked() const noexcept { return locked_; }  // index of the place, -1: none
  double stiffness() const noexcept { return peak_ / (0.5 * radius_); }

 private:
  void move_lock(const Vec2& proxy, EffectTick& tick) noexcept {
    const auto within = [&](int i, double reach) {
      return (places_[static_cast<std::size_t>(i)] - proxy).squaredNorm() <= reach * reach;
    };
    if (locked_ >= 0 && !within(locked_, radius_)) {
      tick.tell({EffectEvent::Kind::kUnlocked, locked_});
      locked_ = -1;
    }
    for (int i = 0; i < count_ && locked_ < 0; ++i) {
      if (!within(i, 0.5 * radius_)) continue;
      locked_ = i;
      tick.tell({EffectEvent::Kind::kLocked, i});
    }
  }

  std::array<Vec2, kMostDetents> places_{};
  int count_ = 0;
  double radius_;  // [m]
  double peak_;    // [N]
  int locked_ = -1;
};

}  // namespace handrail
