// How long the arm's joints take to come to where they are commanded.
#pragma once

#include <algorithm>

#include "server/base/joints.h"

namespace handrail {

// Least squares of how far the joints are behind over how fast they move, over the last seconds of
// motion. By how fast they move, not how fast they are commanded: what has just begun to move is
// not as far behind as it will be, and would seem quick. Real-time safe.
class LagEstimate {
 public:
  // The joints stand at `q` [rad]; what was found stays.
  void restart(const JointVector& q) noexcept { last_ = q; }
  // One cycle of `dt` [s]: what was measured while `q_command` was the newest command.
  void add(const JointVector& q_command, const JointVector& q_measured, double dt) noexcept {
    constexpr double kSlow = 0.05;     // joints slower than this tell nothing [rad/s]
    constexpr double kMemory = 0.998;  // a cycle of motion
    const JointVector speed = (q_measured - last_) / dt;
    last_ = q_measured;
    if (speed.cwiseAbs().maxCoeff() < kSlow) return;
    behind_ = kMemory * behind_ + (q_command - q_measured).dot(speed);
    speed_ = kMemory * speed_ + speed.squaredNorm();
  }
  // From a command to the arm's being there, within 0 and 0.1 s; 60 ms until it has moved [s].
  double lag() const noexcept { return std::clamp(behind_ / speed_, 0.0, 0.1); }

 private:
  static constexpr double kFirst = 0.06, kWeight = 0.01;
  JointVector last_ = JointVector::Zero();
  double behind_ = kFirst * kWeight;
  double speed_ = kWeight;
};

}  // namespace handrail
