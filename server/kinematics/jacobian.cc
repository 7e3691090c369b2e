#include "server/kinematics/jacobian.h"

#include <cmath>

namespace handrail {

TipJacobian tip_jacobian(const ArmGeometry& arm, const JointVector& q) noexcept {
  const double c1 = std::cos(q[0]), s1 = std::sin(q[0]);
  const double c4 = std::cos(q[3]), s4 = std::sin(q[3]);
  const double s23 = std::sin(q[1] + q[2]), c23 = std::cos(q[1] + q[2]);
  const Vec3 ahead(c1, s1, 0.0), aside(-s1, c1, 0.0), up = Vec3::UnitZ();
  const Vec3 forearm = s23 * ahead + c23 * up;  // along the forearm
  const Vec3 across = c23 * ahead - s23 * up;   // beside it, in the arm's plane

  TipJacobian out;
  const Vec3 wrist_axis = c4 * aside - s4 * across;
  const Vec3 tip_axis = std::cos(q[4]) * forearm + std::sin(q[4]) * (c4 * across + s4 * aside);
  out.angular << up, aside, aside, forearm, wrist_axis, tip_axis;

  const Vec3 shoulder = arm.a1 * ahead + arm.d1 * up;
  const Vec3 elbow = shoulder + arm.a2 * (std::sin(q[1]) * ahead + std::cos(q[1]) * up);
  const Vec3 wrist = elbow - arm.a3 * across + arm.d4 * forearm;
  const Vec3 tip = wrist + arm.d6 * tip_axis;
  const Vec3 origins[kJoints] = {Vec3::Zero(), shoulder, elbow, wrist, wrist, wrist};
  for (int i = 0; i < kJoints; ++i) {
    out.linear.col(i) = out.angular.col(i).cross(tip - origins[i]);
  }
  return out;
}

}  // namespace handrail
