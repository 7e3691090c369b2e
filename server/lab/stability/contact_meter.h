// What a device is given in each contact, and how it moves.
#pragma once

#include <algorithm>
#include <limits>

#include "server/base/plane.h"

namespace handrail {

// A contact lasts from the first force to the next tick without one. What it has given is the work
// of the force so far, less what the device's own friction and damping took meanwhile: a spring
// that begins and ends at rest gives nothing, and before it has ended it has given less.
class ContactMeter {
 public:
  // A tick under a force: its work and what the device took meanwhile [J]. `late`: what may have
  // been made more, as the tick was held longer than it was to be [J].
  void add(bool pushed, double work, double taken, double late) noexcept {
    if (pushed && !in_contact_) given_ = allowed_ = 0.0, ++contacts_;
    in_contact_ = pushed;
    if (!pushed) return;
    given_ += work - taken;
    allowed_ += late;
    worst_ = std::max(worst_, given_);
    over_ = std::max(over_, given_ - allowed_);
  }

  int contacts() const noexcept { return contacts_; }
  double worst() const noexcept { return worst_; }  // given in a contact, at any time of it [J]
  double over() const noexcept { return over_; }    // the same less what late ticks may make [J]

 private:
  bool in_contact_ = false;
  int contacts_ = 0;
  double given_ = 0.0, allowed_ = 0.0, worst_ = 0.0, over_ = 0.0;
};

// Of places: their mean, and how far they lie apart.
class Swing {
 public:
  void add(const Vec2& p) noexcept {
    low_ = low_.cwiseMin(p);
    high_ = high_.cwiseMax(p);
    sum_ += p;
    ++count_;
  }
  Vec2 mean() const noexcept { return sum_ / std::max(count_, 1); }
  // From side to side, along the axis where that is more [m].
  double peak_to_peak() const noexcept { return count_ > 0 ? (high_ - low_).maxCoeff() : 0.0; }

 private:
  Vec2 low_ = Vec2::Constant(std::numeric_limits<double>::infinity());
  Vec2 high_ = Vec2::Constant(-std::numeric_limits<double>::infinity());
  Vec2 sum_ = Vec2::Zero();
  int count_ = 0;
};

}  // namespace handrail
