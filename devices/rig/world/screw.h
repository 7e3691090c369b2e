// A screw in its thread, and the key that turns it.
#pragma once

#include <algorithm>

#include "server/model/simulate.h"

namespace handrail {

// The key twists like a spring once it has crossed its play; past the thread's
// torque the screw slips along, exactly as far as it takes. No step is too
// long. Real-time safe.
class Screw {
 public:
  // `thread`: null for a screw that never turns. `twist`: of the key [N m/rad].
  Screw(const ScrewThreadSpec* thread, double twist) noexcept : turns_(thread != nullptr) {
    if (turns_) thread_ = *thread;
    twist_ = twist;
  }

  // The key stands at `key`, clockwise as one looks at the screw's head, with
  // `play` from end to end [rad]. What it exerts on the screw, clockwise [N m].
  double turn(double key, double play) noexcept {
    const double lead = key - angle_;
    const double strain = lead - std::clamp(lead, -0.5 * play, 0.5 * play);
    const double torque = twist_ * strain;
    const double share = torque > 0.0 ? 1.0 : -thread_.back_share;
    const double most =
        share * (thread_.start + thread_.growth * std::max(0.0, angle_ - thread_.seat));
    if (!turns_ || (torque > 0.0 ? torque <= most : torque >= most)) return torque;
    // Where spring and thread agree: below the seat, or else above.
    double slip = (torque - share * thread_.start) / twist_;
    if (angle_ + slip > thread_.seat) {
      const double growth = share * thread_.growth;
      slip =
          (torque - share * thread_.start - growth * (angle_ - thread_.seat)) / (twist_ + growth);
    }
    angle_ += slip;
    return torque - twist_ * slip;
  }
  // Tightened by so much since the start [rad].
  double angle() const noexcept { return angle_; }
  // From which the screw turns [N m].
  double start() const noexcept { return thread_.start; }

 private:
  bool turns_;
  ScrewThreadSpec thread_;
  double twist_ = 0.0;
  double angle_ = 0.0;
};

}  // namespace handrail
