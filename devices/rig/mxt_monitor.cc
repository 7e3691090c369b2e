#include "devices/rig/mxt_monitor.h"

#include <cmath>

#include "server/base/units.h"

namespace handrail {
namespace {

// Angles of R = Rz(C) Ry(B) Rx(A) as (A, B, C) [rad]; with B = +-90 degrees C is 0.
Vec3 abc_of(const Mat3& r) {
  const double cos_b = std::hypot(r(0, 0), r(1, 0));
  const double b = std::atan2(-r(2, 0), cos_b);
  if (cos_b < 1e-9) return {std::atan2(-r(1, 2), r(1, 1)), b, 0.0};
  return {std::atan2(r(2, 1), r(2, 2)), b, std::atan2(r(1, 0), r(0, 0))};
}

MxtBlock pose_block(const ArmGeometry& geometry, const JointVector& q) {
  MxtBlock block;
  const Pose X_ST = forward(geometry, q);
  const Vec3 abc = abc_of(X_ST.q.toRotationMatrix());
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    block.set_real(at, X_ST.p[i] / kMm);
    block.set_real(at + 3, abc[i]);
  }
  const Branch branch = branch_of(geometry, q);
  block.words[8] = (branch.shoulder_back ? 0u : 4u) | (branch.elbow_down ? 0u : 2u) |
                   (branch.wrist_flipped ? 0u : 1u);
  return block;
}

}  // namespace

MxtBlock monitor_block(MxtType type, const ServoArm& arm) noexcept {
  MxtBlock block;
  switch (type) {
    case MxtType::kPose:
    case MxtType::kFilteredPose: return pose_block(arm.geometry(), arm.target());
    case MxtType::kFeedbackPose: return pose_block(arm.geometry(), arm.measured());
    case MxtType::kJoint:
    case MxtType::kFilteredJoint: block.set_joints(arm.target()); break;
    case MxtType::kFeedbackJoint: block.set_joints(arm.measured()); break;
    case MxtType::kNull:
    case MxtType::kPulse:
    case MxtType::kFilteredPulse:
    case MxtType::kFeedbackPulse:
    case MxtType::kCommandCurrent:
    case MxtType::kFeedbackCurrent: break;
  }
  return block;
}

}  // namespace handrail
