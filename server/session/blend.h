// Easing: what was jumped over is kept as an offset and let go at a bounded rate.
#pragma once

#include <algorithm>

#include "server/base/spatial.h"

namespace handrail {

// A decaying offset. When a reference jumps (tool called or dropped), absorb the jump, so that
// reference + offset is continuous; then the offset shrinks by at most `rate` a second, along a
// straight line, with an exponential end. Motion of the reference passes 1:1 meanwhile. A chase
// that limits the sum instead would wind up behind a moving hand. Real-time safe.
class Blend {
 public:
  void clear() noexcept { offset_.setZero(); }
  // `jump` is the old value minus the new one.
  void absorb(const Vec3& jump) noexcept { offset_ += jump; }
  const Vec3& offset() const noexcept { return offset_; }
  bool active() const noexcept { return offset_.squaredNorm() > 0.0; }

  // Lets go for `dt` seconds at `rate` per second at most.
  void decay(double rate, double dt) noexcept {
    const double size = offset_.norm();
    if (size == 0.0) return;
    const double step = dt * std::min(rate, size / kTail);
    if (size - step < kNothing) {
      offset_.setZero();
    } else {
      offset_ *= (size - step) / size;
    }
  }

 private:
  static constexpr double kTail = 0.1;      // time constant of the end [s]
  static constexpr double kNothing = 1e-7;  // 0.1 um or 0.1 urad: below what any arm can show
  Vec3 offset_ = Vec3::Zero();
};

}  // namespace handrail
