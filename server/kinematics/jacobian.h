// How the tip moves with the joints.
#pragma once

#include "server/kinematics/rv2a.h"

namespace handrail {

// Column i: what the tip does when joint i turns, frame S.
struct TipJacobian {
  Eigen::Matrix<double, 3, kJoints> linear;   // [m/rad]
  Eigen::Matrix<double, 3, kJoints> angular;  // unit axes
};

// At `q`. Real-time safe.
TipJacobian tip_jacobian(const ArmGeometry& arm, const JointVector& q) noexcept;

}  // namespace handrail
