// The minimum-jerk polynomial of a vector (Flash and Hogan 1985), generalised to start in motion.
#pragma once

#include "server/base/spatial.h"

namespace handrail {

// Position, speed and acceleration of a moving vector.
struct VectorMotion {
  Vec3 p = Vec3::Zero();
  Vec3 v = Vec3::Zero();
  Vec3 a = Vec3::Zero();
};

// Quintic from a state of motion to rest, the curve of least integrated squared jerk between those
// ends. From rest it is D (10 s^3 - 15 s^4 + 6 s^5), whose peak speed is 1.875 D / T. Pure.
class MinJerk {
 public:
  MinJerk() = default;
  // `duration` > 0 [s].
  MinJerk(const VectorMotion& from, const Vec3& goal, double duration) noexcept
      : goal_(goal), duration_(duration) {
    const Vec3 d = goal - from.p;
    const Vec3 v = duration * from.v;
    const Vec3 a = duration * duration * from.a;
    c_[0] = from.p;
    c_[1] = v;
    c_[2] = 0.5 * a;
    c_[3] = 10.0 * d - 6.0 * v - 1.5 * a;
    c_[4] = -15.0 * d + 8.0 * v + 1.5 * a;
    c_[5] = 6.0 * d - 3.0 * v - 0.5 * a;
  }

  double duration() const noexcept { return duration_; }

  // At `t` seconds after the start, t >= 0; at rest on the goal from `duration` on.
  VectorMotion at(double t) const noexcept {
    if (t >= duration_) return {goal_, Vec3::Zero(), Vec3::Zero()};
    const double s = t / duration_;
    const double per_s = 1.0 / duration_;
    VectorMotion m;
    m.p = c_[0] + s * (c_[1] + s * (c_[2] + s * (c_[3] + s * (c_[4] + s * c_[5]))));
    m.v = per_s *
          (c_[1] + s * (2.0 * c_[2] + s * (3.0 * c_[3] + s * (4.0 * c_[4] + s * 5.0 * c_[5]))));
    m.a = per_s * per_s * (2.0 * c_[2] + s * (6.0 * c_[3] + s * (12.0 * c_[4] + s * 20.0 * c_[5])));
    return m;
  }

 private:
  Vec3 c_[6] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  Vec3 goal_ = Vec3::Zero();
  double duration_ = 1.0;
};

}  // namespace handrail
