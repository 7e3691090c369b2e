// How long the arm's joints take to come to where they are commanded.
#pragma once

#include <algorithm>

#include "server/base/joints.h"

namespace handrail {

// Least squares of how far the joints are behind over how fast they are commanded, over the last
// seconds of motion. Real-time safe.
class LagEstimate {
 public:
  // One cycle of `dt` [s]: what was measured while `q_command`, `step` [rad] after the one before,
  // was the newest command.
  void add(const JointVector& q_command, const JointVector& step, const JointVector& q_measured,
           double dt) noexcept {
    constexpr double kSlow = 0.05;     // joints slower than this tell nothing [rad/s]
    constexpr double kMemory = 0.998;  // a cycle of motion
    const JointVector speed = step / dt;
    if (speed.cwiseAbs().maxCoeff() < kSlow) return;
    behind_ = kMemory * behind_ + (q_command - q_measured).dot(speed);
    speed_ = kMemory * speed_ + speed.squaredNorm();
  }
  // From a command to the arm's being there, within 0 and 0.1 s; 60 ms until it has moved [s].
  double lag() const noexcept { return std::clamp(behind_ / speed_, 0.0, 0.1); }

 private:
  static constexpr double kFirst = 0.06, kWeight = 0.01;
  double behind_ = kFirst * kWeight;
  double speed_ = kWeight;
};

}  // namespace handrail
