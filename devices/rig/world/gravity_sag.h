// The payload's weight, on the joints and on the sensor.
#pragma once

#include "server/base/joints.h"
#include "server/base/spatial.h"
#include "server/base/units.h"
#include "server/kinematics/jacobian.h"
#include "server/model/simulate.h"

namespace handrail {

// Real-time safe.
class GravitySag {
 public:
  // `spec`: null for no weight.
  explicit GravitySag(const GravitySpec* spec) noexcept {
    if (spec != nullptr) spec_ = *spec;
  }
  // How far the joints give way to the weight at `q` [rad].
  JointVector bend(const ArmGeometry& arm, const JointVector& q) const noexcept {
    if (spec_.mass <= 0.0) return JointVector::Zero();
    const TipJacobian J = tip_jacobian(arm, q);
    const Vec3 centre = forward(arm, q).q * spec_.p_TC;
    JointVector out;
    for (int i = 0; i < kJoints; ++i) {
      // By virtual work: how fast the centre rises with the joint.
      const double rise = J.linear(2, i) + J.angular.col(i).cross(centre).z();
      out[i] = -spec_.mass * kStandardGravity * rise / spec_.stiffness[i];
    }
    return out;
  }
  // The weight as the sensor feels it, at the tip, tip axes.
  Wrench weight(const Quat& q_ST) const noexcept {
    const Vec3 force = q_ST.conjugate() * Vec3(0, 0, -spec_.mass * kStandardGravity);
    return {force, spec_.p_TC.cross(force)};
  }

 private:
  GravitySpec spec_;
};

}  // namespace handrail
