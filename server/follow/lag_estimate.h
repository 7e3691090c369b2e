// How long the arm's joints take to come to where they are commanded.
#pragma once

#include <algorithm>

#include "server/base/joints.h"

namespace handrail {

// A promise rests on it, so it may be believed too long but not too short. It begins with the
// longest lag of a sound arm and is led from there by cycles of motion, each of which tells how far
// the joints are behind over how fast they move: how fast they move, not how fast they are
// commanded, since what has just begun to move is not as far behind as it will be.
//
// A cycle counts only if the one before told of the same motion. A reading that jumps or is missing
// (`q_measured` is the last one again) therefore counts for nothing, nor do the two after it; no
// caller has to say so. What counts leads by a bounded step, and four times as far to a longer lag
// as to a shorter one: until four cycles of five tell of a shorter one it is not believed.
// Real-time safe.
class LagEstimate {
 public:
  // Of the slowest arm that is taken to follow (FollowingSettings::slowest) [s].
  static constexpr double kMost = 0.1;

  // The joints stand at `q` [rad]: another arm for all that is known.
  void restart(const JointVector& q) noexcept {
    *this = LagEstimate();
    q_ = q;
  }
  // One cycle of `dt` [s]: what was measured while `q_command` was the newest command.
  void add(const JointVector& q_command, const JointVector& q_measured, double dt) noexcept {
    const JointVector last = speed_;
    speed_ = (q_measured - q_) / dt;
    q_ = q_measured;
    const double speed = speed_.norm();
    if (!(speed > kSlow && (speed_ - last).norm() < kAgree * speed)) return;
    const double told = (q_command - q_measured).dot(speed_) / (speed * speed);
    lag_ = std::clamp(lag_ + std::clamp(told - lag_, -kDown, kUp), 0.0, kMost);
  }
  // From a command to the arm's being there, within 0 and kMost [s].
  double lag() const noexcept { return lag_; }

 private:
  // Encoders that are off by 0.04 mm at the tip, 1e-4 rad, are 5 ms at it. A tip that is led to no
  // more than 20 mm/s, 0.5 m from the base's axes, moves its joints by twice that [rad/s].
  static constexpr double kSlow = 0.02;
  // Of the speed. A reply that is missing makes it 0, 2 and 1 times what it was.
  static constexpr double kAgree = 0.5;
  // A cycle. From kMost to the 50 ms of the usual arm in 50 cycles, a third of a second [s].
  static constexpr double kDown = 1e-3;
  static constexpr double kUp = 4.0 * kDown;

  JointVector q_ = JointVector::Zero();      // measured last
  JointVector speed_ = JointVector::Zero();  // in the last cycle [rad/s]
  double lag_ = kMost;
};

}  // namespace handrail
