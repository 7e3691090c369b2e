// The tip over the last commands, and how far its stop takes it.
#pragma once

#include <algorithm>
#include <array>

#include "server/lab/faults/audit/joint_audit.h"

namespace handrail {

// Real-time safe.
class TipWay {
 public:
  explicit TipWay(double dt) noexcept : dt_(dt) {}

  void stand(const Vec3& tip) noexcept { tips_.fill(tip); }
  void commanded(const Vec3& tip) noexcept { tips_ = {tip, tips_[0], tips_[1]}; }
  // That the joints needed at the last command [s].
  void set_stop_time(double seconds) noexcept { stop_time_ = seconds; }

  double stop_time() const noexcept { return stop_time_; }
  const Vec3& tip() const noexcept { return tips_[0]; }
  // How far the tip goes [m] that loses speed v and acceleration a together, evenly, in the time T
  // that the joints may need: the cubic through both ends, v T / 2 + a T^2 / 12. The bend of its
  // path may turn all of it outward.
  double even_way() const noexcept {
    const Vec3 step = tips_[0] - tips_[1], last = tips_[1] - tips_[2];
    const double cycles = stop_time_ / dt_;
    return cycles / 2.0 * step.norm() + cycles * cycles / 12.0 * (step - last).norm();
  }
  // How far it goes at most [m] when it has to rest within `time` [s]: no stop is longer than going
  // on at its speed until then, and with twice what of the acceleration an even one keeps. A stop
  // that first lets an acceleration fade, beside a bend, is longer than an even one.
  double longest_way(double time) const noexcept {
    const Vec3 step = tips_[0] - tips_[1], last = tips_[1] - tips_[2];
    const double cycles = std::max(0.0, time / dt_);
    return cycles * step.norm() + cycles * cycles / 6.0 * (step - last).norm();
  }
  double way_to_rest(const JointAudit& joints) const noexcept {
    return std::max(even_way(), joints.way_of_joints());
  }

 private:
  double dt_;
  std::array<Vec3, 3> tips_{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};  // newest first
  double stop_time_ = 0.0;
};

}  // namespace handrail
