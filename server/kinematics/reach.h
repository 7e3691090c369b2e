// Which poses the arm can take, and the nearest to one it cannot.
#pragma once

#include "server/base/joints.h"
#include "server/kinematics/rv2a.h"
#include "server/model/tip_space.h"

namespace handrail {

struct Reached {
  JointVector q;
  Pose X;                  // tip at q, but for what the step rounds
  std::int8_t joint = -1;  // 0 to 5: whose range ends there; -1: it is the pose asked for
  bool arm = false;        // the place had to yield
};

// The pose in reach for one asked for, some steps toward it from `seed`: asked again from there,
// again and again, it comes to the nearest. The place comes first: where the arm, turned as at
// `seed`, does not get there it yields, along `space` if it is asked for on it. Then the tip turns
// as near to what is asked for as it may in its place. On the seed's way of standing (shoulder and
// elbow), of the wrist's two ways the one that turns it least within its ranges, `inside` [rad]
// from every range's end. Real-time safe: one inverse kinematics where X is in reach, else at most
// three, and four least squares of three and of six unknowns each.
Reached nearest_reachable(const ArmGeometry& arm, const JointLimits& limits, const TipSpace& space,
                          const Pose& X, const JointVector& seed,
                          const JointVector& inside) noexcept;

}  // namespace handrail
