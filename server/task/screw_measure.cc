#include "server/task/screw_measure.h"

#include <algorithm>

namespace handrail {

void ScrewMeasure::add(double dt, const Vec3& p_ST, double force) noexcept {
  path_.add(p_ST);
  max_ = std::max(max_, force);
  if (force <= kTouching) return;
  impulse_ += force * dt;
  contact_ += dt;
}

ScrewMeasured ScrewMeasure::measured() const noexcept {
  return {path_.length(), contact_ > 0.0 ? impulse_ / contact_ : 0.0, max_, impulse_, contact_};
}

}  // namespace handrail
