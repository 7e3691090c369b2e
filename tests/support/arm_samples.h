// Seeded joint vectors and comparisons for tests of the arm.
#pragma once

#include <cmath>
#include <numbers>
#include <random>

#include "server/base/spatial.h"
#include "server/base/units.h"
#include "server/kinematics/rv2a.h"

namespace handrail::test {

inline JointVector joints_deg(double j1, double j2, double j3, double j4, double j5, double j6) {
  JointVector q;
  q << j1, j2, j3, j4, j5, j6;
  return q * kDeg;
}

// The mount of a bent tool: its tip 60 mm aside of the flange's axis, and pointing aside.
inline Pose bent() { return {Vec3(0.06, -0.02, -0.05), rotation_exp(Vec3(0.3, 0.9, -0.4))}; }
inline ArmGeometry bent_arm() {
  ArmGeometry arm;
  arm.X_AT = bent();
  return arm;
}

// Uniform within the arm's joint ranges.
inline JointVector random_joints(std::mt19937_64& random) {
  const JointLimits& limits = rv2a_limits();
  JointVector q;
  for (int i = 0; i < kJoints; ++i) {
    q[i] = std::uniform_real_distribution<double>(limits.lower[i], limits.upper[i])(random);
  }
  return q;
}

// Greatest joint difference with whole turns taken out [rad].
inline double turn_free_distance(const JointVector& a, const JointVector& b) {
  double worst = 0.0;
  for (int i = 0; i < kJoints; ++i) {
    worst = std::max(worst, std::abs(std::remainder(a[i] - b[i], 2.0 * std::numbers::pi)));
  }
  return worst;
}

inline double position_error(const Pose& a, const Pose& b) { return (a.p - b.p).norm(); }

// Angle that stays exact near zero: the chord of the two quaternions, whichever their signs [rad].
inline double rotation_error(const Pose& a, const Pose& b) {
  const Eigen::Vector4d u = a.q.normalized().coeffs(), v = b.q.normalized().coeffs();
  return 2.0 * std::min((u - v).norm(), (u + v).norm());
}

}  // namespace handrail::test
