// The vertical plane through shoulder, elbow and wrist centre that J1 turns about the base axis.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "server/kinematics/rv2a.h"

namespace handrail {

struct ArmPlane {
  double radius = 0.0;  // wrist centre ahead of the J1 axis, negative behind it [m]
  double height = 0.0;  // wrist centre above the mounting face [m]
  double elbow_sine =
      0.0;  // forearm length times the sine of the elbow angle [m]; 0 when stretched
};

// From sine and cosine of J2 and of J2 + J3. Real-time safe.
inline ArmPlane arm_plane(const ArmGeometry& arm, double sin_2, double cos_2, double sin_23,
                          double cos_23) noexcept {
  const double sin_3 = sin_23 * cos_2 - cos_23 * sin_2;
  const double cos_3 = cos_23 * cos_2 + sin_23 * sin_2;
  return {arm.a1 + arm.a2 * sin_2 - arm.a3 * cos_23 + arm.d4 * sin_23,
          arm.d1 + arm.a2 * cos_2 + arm.a3 * sin_23 + arm.d4 * cos_23,
          arm.d4 * sin_3 - arm.a3 * cos_3};
}

inline ArmPlane arm_plane(const ArmGeometry& arm, const JointVector& q) noexcept {
  const double q_23 = q[1] + q[2];
  return arm_plane(arm, std::sin(q[1]), std::cos(q[1]), std::sin(q_23), std::cos(q_23));
}

// Whole turns in `angle`, rounded to nearest: adding 1.5 * 2^52 leaves no bits for a fraction.
// For angles below 1e15 rad. Real-time safe.
inline double nearest_turns(double angle) noexcept {
  constexpr double kPerTurn = 0.15915494309189533577;  // 1 / (2 pi)
  constexpr double kNoFraction = 6755399441055744.0;
  return (angle * kPerTurn + kNoFraction) - kNoFraction;
}

}  // namespace handrail
