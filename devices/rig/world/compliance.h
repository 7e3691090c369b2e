// Arm and tool as springs in series with what the tip touches.
#pragma once

#include "server/base/spatial.h"
#include "server/model/simulate.h"

namespace handrail {

// How far the tip gives way to a force on it, frame S [m/N]. Real-time safe.
class Compliance {
 public:
  explicit Compliance(const Simulate& list) noexcept {
    if (const auto* arm = list.find<ArmComplianceSpec>()) arm_ = 1.0 / arm->stiffness;
    if (const auto* tool = list.find<ToolComplianceSpec>()) {
      lateral_ = 1.0 / tool->lateral;
      along_ = 1.0 / tool->axial - lateral_;
    }
  }
  Mat3 at(const Quat& q_ST) const noexcept {
    const Vec3 z = q_ST * Vec3::UnitZ();
    return (arm_ + lateral_) * Mat3::Identity() + along_ * z * z.transpose();
  }

 private:
  double arm_ = 0.0;      // [m/N]
  double lateral_ = 0.0;  // of the tool
  double along_ = 0.0;    // what its axis adds
};

}  // namespace handrail
