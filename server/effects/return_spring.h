// Pulls the hand back to a point, as a gear lever to neutral.
#pragma once

#include "server/effects/effect_input.h"

namespace handrail {

// f = K (x_0 - x), at most F, while no detent holds the hand (dissertation 2.3.2); it comes and
// goes within 50 ms. Says when the hand is back: within `home` of the point, having been twice as
// far.
class ReturnSpring {
 public:
  static constexpr EffectKind kKind = EffectKind::kReturn;
  ReturnSpring(const EffectSpec& e, const Plant&) noexcept
      : ReturnSpring(e.at, e.stiffness, e.peak, e.radius) {}
  ReturnSpring(const Vec2& to, double stiffness, double peak, double home) noexcept
      : to_(to), stiffness_(stiffness), peak_(peak), home_(home) {}

  void restart(const Vec2&) noexcept {}

  Vec2 force(const EffectInput& in, EffectTick& tick) noexcept {
    const Vec2 back = to_ - in.hand;
    const double distance = back.norm();
    if (distance > 2.0 * home_) away_ = true;
    if (away_ && distance < home_) {
      away_ = false;
      tick.tell({EffectEvent::Kind::kReturned, 0});
    }
    const double pull = stiffness_ * distance;
    const double share = fade_.move(!tick.locked, in.dt);
    Vec2 f = (share * (pull > peak_ ? peak_ / distance : stiffness_)) * back;
    tick.by_spring(f, share * stiffness_);
    return f;
  }

  double stiffness() const noexcept { return stiffness_; }

 private:
  Vec2 to_;
  double stiffness_, peak_;  // [N/m], [N]
  double home_;              // [m]
  bool away_ = false;
  Fade fade_;
};

}  // namespace handrail
