// What a sequence of random events is drawn with.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "server/base/random.h"
#include "server/base/spatial.h"

namespace handrail {

// The same seed gives the same numbers on every machine.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) noexcept : random_(seed) {}

  double between(double low, double high) noexcept {
    return low + (high - low) * random_.uniform();
  }
  bool chance(double share) noexcept { return random_.uniform() < share; }
  // 0 to `n` - 1, n > 0.
  int below(int n) noexcept {
    return std::min(static_cast<int>(random_.uniform() * static_cast<double>(n)), n - 1);
  }
  Vec3 unit() noexcept {
    const double z = between(-1.0, 1.0), angle = between(0.0, 2.0 * std::numbers::pi);
    const double r = std::sqrt(std::max(1.0 - z * z, 0.0));
    return {r * std::cos(angle), r * std::sin(angle), z};
  }

 private:
  Random random_;
};

// Something that happens now and then for a while; in half of all sequences it never does.
class Spell {
 public:
  // Each lasts from `shortest` to `longest` [s].
  Spell(Draw& draw, double shortest, double longest) noexcept
      : shortest_(shortest), longest_(longest) {
    if (draw.chance(0.5)) every_ = draw.between(0.05, 1.0);
  }

  // Lets `elapsed` [s] pass. True while it lasts.
  bool step(Draw& draw, double elapsed) noexcept {
    left_ -= elapsed;
    began_ = false;
    if (left_ > 0.0) return true;
    if (every_ == 0.0 || !draw.chance(elapsed / every_)) return false;
    left_ = draw.between(shortest_, longest_);
    return began_ = true;
  }
  // In the step just made.
  bool began() const noexcept { return began_; }

 private:
  double shortest_, longest_;
  double every_ = 0.0;  // mean time between two [s]; 0: never
  double left_ = 0.0;   // [s]
  bool began_ = false;
};

}  // namespace handrail
