#include "server/kinematics/rv2a.h"

#include <cmath>
#include <numbers>

#include "server/kinematics/arm_plane.h"

namespace handrail {

Vec3 ArmGeometry::wrist_to_tip(const Quat& q_ST) const noexcept {
  if (!X_AT) return d6 * (q_ST * Vec3::UnitZ());
  return q_ST * (X_AT->q.conjugate() * (X_AT->p + d6 * Vec3::UnitZ()));
}

double ArmGeometry::tip_radius() const noexcept {
  return X_AT ? (X_AT->p + d6 * Vec3::UnitZ()).norm() : d6;
}

double ArmGeometry::tip_aside() const noexcept { return X_AT ? X_AT->p.head<2>().norm() : 0.0; }

// With the joint offsets and the quarter-turn twists multiplied out, the six rotations of the chain
// are Rz(J1) Ry(J2 + J3) Rz(J4) Ry(J5) Rz(J6).
Pose forward(const ArmGeometry& arm, const JointVector& q) noexcept {
  const double c1 = std::cos(0.5 * q[0]), s1 = std::sin(0.5 * q[0]);
  const double c23 = std::cos(0.5 * (q[1] + q[2])), s23 = std::sin(0.5 * (q[1] + q[2]));
  const double c5 = std::cos(0.5 * q[4]), s5 = std::sin(0.5 * q[4]);
  const double half_sum = 0.5 * (q[5] + q[3]), half_difference = 0.5 * (q[5] - q[3]);
  const Quat forearm(c1 * c23, -s1 * s23, c1 * s23, s1 * c23);
  const Quat wrist(c5 * std::cos(half_sum), s5 * std::sin(half_difference),
                   s5 * std::cos(half_difference), c5 * std::sin(half_sum));

  const ArmPlane plane =
      arm_plane(arm, std::sin(q[1]), std::cos(q[1]), 2.0 * s23 * c23, (c23 - s23) * (c23 + s23));
  Pose X_ST;
  X_ST.q = forearm * wrist;
  const double w = X_ST.q.w(), x = X_ST.q.x(), y = X_ST.q.y(), z = X_ST.q.z();
  X_ST.p << (c1 - s1) * (c1 + s1) * plane.radius + 2.0 * arm.d6 * (x * z + w * y),
      2.0 * s1 * c1 * plane.radius + 2.0 * arm.d6 * (y * z - w * x),
      plane.height + arm.d6 * (w * w + z * z - x * x - y * y);
  return arm.X_AT ? X_ST * *arm.X_AT : X_ST;
}

Branch branch_of(const ArmGeometry& arm, const JointVector& q) noexcept {
  const ArmPlane plane = arm_plane(arm, q);
  const double q5 = q[4] - 2.0 * std::numbers::pi * nearest_turns(q[4]);
  return {plane.radius < 0.0, plane.elbow_sine < 0.0, q5 < 0.0};
}

SingularityMargin singularity_margin(const ArmGeometry& arm, const JointVector& q) noexcept {
  const ArmPlane plane = arm_plane(arm, q);
  return {std::abs(std::sin(q[4])), std::abs(plane.radius),
          std::abs(plane.elbow_sine) / std::sqrt(arm.a3 * arm.a3 + arm.d4 * arm.d4)};
}

}  // namespace handrail
