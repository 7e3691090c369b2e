// The arm as a scene has it.
#pragma once

#include "server/kinematics/rv2a.h"
#include "server/model/scene.h"

namespace handrail {

inline ArmGeometry arm_of(const Scene& scene) {
  ArmGeometry arm;
  arm.d6 = scene.tip_length;
  arm.X_AT = scene.X_AT;
  return arm;
}

}  // namespace handrail
