#include "server/model/rv2a_limits.h"

#include "server/base/units.h"

namespace handrail {

const JointLimits& rv2a_limits() noexcept {
  static const JointLimits limits = [] {
    constexpr double kRampTime = 0.15;  // [s]
    JointLimits l;
    l.lower << -160.0, -45.0, 50.0, -160.0, -120.0, -200.0;
    l.upper << 160.0, 135.0, 170.0, 160.0, 120.0, 200.0;
    l.max_speed << 150.0, 150.0, 180.0, 240.0, 180.0, 330.0;
    l.lower *= kDeg;
    l.upper *= kDeg;
    l.max_speed *= kDeg;
    l.max_acceleration = l.max_speed / kRampTime;
    l.max_jerk = l.max_acceleration / kJerkTime;
    return l;
  }();
  return limits;
}

}  // namespace handrail
