// Play between motor and joint.
#pragma once

#include "server/base/joints.h"
#include "server/model/simulate.h"

namespace handrail {

// The joint stays where it is until the motor has crossed the play. Real-time
// safe.
class Backlash {
 public:
  // `spec`: null for none. Motor and joint start alike, in the middle of the
  // play.
  Backlash(const BacklashSpec* spec, const JointVector& q) noexcept : q_(q) {
    half_.setZero();
    if (spec != nullptr) half_ = 0.5 * spec->play;
  }
  // Where the joints are with the motors at `q` [rad].
  const JointVector& follow(const JointVector& q) noexcept {
    q_ = q_.cwiseMax(q - half_).cwiseMin(q + half_);
    return q_;
  }

 private:
  JointVector half_;
  JointVector q_;
};

}  // namespace handrail
