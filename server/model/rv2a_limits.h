// What the Mitsubishi RV-2A may do, joint by joint.
#pragma once

#include "server/base/joints.h"

namespace handrail {

// Ranges and speeds of the dissertation's Table 3.1. That table prints J2 in the DH variable; here
// it is the controller's J2, -45 to +135 degrees. Accelerations and jerks are ours, for want of a
// source: top speed in 0.15 s, full acceleration in kJerkTime.
const JointLimits& rv2a_limits() noexcept;

inline constexpr double kJerkTime = 0.02;  // from no acceleration to the most [s]

}  // namespace handrail
