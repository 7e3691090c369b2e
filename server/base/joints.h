// Joint-space vectors of a six-axis arm.
#pragma once

#include <Eigen/Core>

namespace handrail {

inline constexpr int kJoints = 6;

// One value a joint, J1 first. [rad] unless the name says otherwise.
using JointVector = Eigen::Matrix<double, kJoints, 1>;

// What a controller lets each joint do; every element strictly positive but the range's low end.
struct JointLimits {
  JointVector lower = JointVector::Zero();             // [rad]
  JointVector upper = JointVector::Zero();             // [rad]
  JointVector max_speed = JointVector::Zero();         // [rad/s]
  JointVector max_acceleration = JointVector::Zero();  // [rad/s^2]
  JointVector max_jerk = JointVector::Zero();          // [rad/s^3]
};

}  // namespace handrail
