#include "server/kinematics/jacobian.h"

#include "server/kinematics/tip_place.h"

namespace handrail {

TipJacobian tip_jacobian(const ArmGeometry& arm, const JointVector& q) noexcept {
  return TipPlace(arm, q).jacobian();
}

}  // namespace handrail
