// A point that is dragged along by the hand: friction in terms of position.
#pragma once

#include <algorithm>

#include "server/base/plane.h"

namespace handrail {

struct SliderLaw {
  double coupling = 2500.0;  // k, > 0 [N/m]
  double viscosity = 0.0;    // B against the slider's motion, >= 0, may be infinite [N s/m]
  double yield = 25.0;       // the slider gives way beyond this force, >= 0 [N]
};

// A slider held by viscosity B, tied to the hand x by a spring k and a small damper b:
//
//   f = -k (x - s) - b x',   (B - b) s' = k (x - s),   |f| <= yield,   b = min(B, 3/4 k T).
//
// At a steady speed f = -B x' exactly, for every B. The hand never meets more than the stiffness k,
// so nothing depends on B T / m < 2, the limit of a force -B x' that is held for a period T: the
// slider's equation is solved by implicit Euler, and b makes up for the half period by which a held
// spring force is late (k T / 2). Without a velocity there is no noise of one: a count of the
// device changes the force by at most 7/4 k counts. With B infinite and a yield it is the
// elasto-plastic friction of Hayward and Armstrong (2000): at rest it stays put and does not creep.
// Real-time safe.
class Slider {
 public:
  void restart(const Vec2& hand) noexcept { at_ = last_ = hand; }

  // The hand is at `hand`; the force on it [N]. `dt` > 0 [s].
  Vec2 force(const Vec2& hand, const SliderLaw& law, double dt) noexcept {
    const double k = law.coupling;
    const double b = std::min(law.viscosity, 0.75 * k * dt);
    at_ += (k * dt / (law.viscosity - b + k * dt)) * (hand - at_);
    const Vec2 stretch = hand - at_;
    const double stretched = k * stretch.norm();
    if (stretched > law.yield) at_ = hand - (law.yield / stretched) * stretch;
    spring_ = k * (at_ - hand);
    Vec2 f = spring_ - (b / dt) * (hand - last_);
    last_ = hand;
    const double size = f.norm();
    if (size > law.yield) f *= law.yield / size;
    return f;
  }

  // Of the last force, what the spring gave [N].
  const Vec2& spring() const noexcept { return spring_; }

 private:
  Vec2 spring_ = Vec2::Zero();  // [N]
  Vec2 at_ = Vec2::Zero();      // the slider [m]
  Vec2 last_ = Vec2::Zero();    // the hand a tick before [m]
};

}  // namespace handrail
