// The smallest turns of the joints that bring the tip to a place.
#pragma once

#include <Eigen/LU>

#include "server/kinematics/jacobian.h"
#include "server/motion/stop_plan.h"

namespace handrail {

// Around one pose; small in units of what each joint can do. Real-time safe.
struct PlaceSolver {
  PlaceSolver(const PlanLimits& limits, const JointVector& q) noexcept {
    constexpr double kDamping = 1e-9;  // keeps it bounded where the tip cannot go some way
    J = tip_jacobian(limits.guard.arm, q).linear;
    JointVector weight;
    for (int i = 0; i < kJoints; ++i) {
      const double a = limits.axis[static_cast<std::size_t>(i)].acceleration;
      weight[i] = a * a;
    }
    const Eigen::Matrix<double, kJoints, 3> WJt = weight.asDiagonal() * J.transpose();
    const Mat3 H = J * WJt;
    R = WJt * (H + kDamping * H.trace() * Mat3::Identity()).inverse();
  }
  // Brings the tip to `p` [m], some hundredths of a radian away, to below a nanometre.
  void correct(const ArmGeometry& arm, const Vec3& p, JointVector& q) const noexcept {
    for (int i = 0; i < 5; ++i) {
      const Vec3 off = p - forward(arm, q).p;
      q += R * off;
      if (off.squaredNorm() < 1e-18) break;
    }
  }

  Eigen::Matrix<double, 3, kJoints> J;  // how the tip moves with the joints [m/rad]
  Eigen::Matrix<double, kJoints, 3> R;  // [rad/m]
};

}  // namespace handrail
