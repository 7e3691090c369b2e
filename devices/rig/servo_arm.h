// The arm behind the controller: six position servos that lag, and encoders.
#pragma once

#include <cstdint>

#include "server/base/joints.h"
#include "server/base/random.h"
#include "server/base/spatial.h"
#include "server/kinematics/rv2a.h"

namespace handrail {

struct ServoArmOptions {
  std::uint64_t seed = 1;
  double lag = 0.045;    // nominal time constant of every joint [s], up to 0.060; 0: none
  double spread = 0.03;  // joints drawn uniformly within lag (1 +- spread), 0 to 0.3
  JointVector joint_lag = JointVector::Zero();  // > 0: that joint's own time constant [s]
  double repeatability = 4e-5;  // RMS distance of the measured from the true tip at a stop [m]
  JointVector q_start = default_start();  // [rad]
  ArmGeometry geometry;                   // where the tip is

  // J = (0, 0, 90, 0, 90, 0) degrees: forearm level, tool down.
  static JointVector default_start() noexcept;
};

// Every joint follows the held target as a first-order lag, dq/dt = (target - q) / lag, in closed
// form: any split of a span of time gives the same joints. Encoders are off by a small offset that
// is drawn anew when the arm sets out after a stop and eased into with the joint's own lag, so that
// the measured path has no white noise, yet a pose reached twice reads differently. All calls are
// real-time safe.
class ServoArm {
 public:
  explicit ServoArm(const ServoArmOptions& options) noexcept;

  // Sets the target to follow [rad], finite.
  void command(const JointVector& q_target) noexcept;
  // Lets `dt` >= 0 seconds pass.
  void advance(double dt) noexcept;

  const JointVector& target() const noexcept { return q_target_; }
  // Where the joints are, without any noise [rad].
  const JointVector& joints() const noexcept { return q_; }
  // What the encoders read [rad].
  JointVector measured() const noexcept { return q_ + offset_; }
  // X_ST of the true joints.
  Pose true_tip() const noexcept { return forward(geometry_, q_); }
  // Time constants in force [s].
  const JointVector& lag() const noexcept { return lag_; }
  const ArmGeometry& geometry() const noexcept { return geometry_; }

 private:
  JointVector draw_offset() noexcept;

  ArmGeometry geometry_;
  double repeatability_;
  Random random_;
  JointVector lag_;
  JointVector q_target_;
  JointVector q_;
  JointVector offset_;
  JointVector offset_target_;
  double held_for_ = 0.0;  // time since the target last changed [s]
};

}  // namespace handrail
