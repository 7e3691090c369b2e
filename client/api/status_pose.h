// Poses as a status has them.
#pragma once

#include "proto/operator.pb.h"
#include "server/base/spatial.h"
#include "server/base/units.h"

namespace handrail {

// Frame S [m]. Zeros and the identity where the master says nothing.
inline Pose pose_of(const pb::PoseMm& pose) {
  Pose X;
  if (pose.position_mm_size() != 3 || pose.quaternion_size() != 4) return X;
  X.p = kMm * Vec3(pose.position_mm(0), pose.position_mm(1), pose.position_mm(2));
  X.q = Quat(pose.quaternion(0), pose.quaternion(1), pose.quaternion(2), pose.quaternion(3));
  return X;
}

}  // namespace handrail
