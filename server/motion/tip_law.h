// How the tip wants to move this cycle, from what the joints could do for it.
#pragma once

#include <algorithm>
#include <array>

#include "server/kinematics/jacobian.h"
#include "server/motion/stop_plan.h"

namespace handrail {

// What of the joints' limits a proposal uses.
struct TipLaw {
  double tip_speed = 1.0;    // [m/s]
  double dt = 0.0071;        // [s]
  double speed_share = 1.0;  // 0..1: of the speed, for a link that ages
  double past = 0.0;         // so far past the target a stop may end [m]
};

// What place and turn may do toward their target and across that way; worked out once a cycle.
// `J`: how the tip moves with the joints.
class TipProposal {
 public:
  TipProposal(const PlanLimits& limits, const TipSpace& space, const TipLaw& law,
              const TipJacobian& J, const TipMotion& from, const Pose& target) noexcept;

  // The tip's next step: toward the target, never beyond where it can stop. The turn gets what the
  // place leaves of each joint. Real-time safe.
  Twist step() const noexcept;

  Twist way() const noexcept { return way_; }
  // What keeps the tip from going faster, when it is not there yet.
  Verdict limiting() const noexcept;

 private:
  // One direction of the motion, a unit of metres and of radians times the turn's length.
  struct Axis {
    Vector6 unit = Vector6::Zero();
    JointVector rate = JointVector::Zero();  // joint turns per unit, absolute
    double ahead = 0.0, step = 0.0, change = 0.0;
    double top = kUnbounded;  // speed beside the joints' own, a cycle
  };
  // Toward the target, what moves across that way, the rest. All with the same share: an orbit
  // round the target turns faster than the jerk lets the change toward it turn, which then points
  // ahead and feeds the orbit; what brakes across must take as much as that can give.
  using Axes = std::array<Axis, 3>;
  // By which joint, and what a unit of it costs.
  struct Weakest {
    double value;
    std::int8_t joint;
  };
  Weakest slowest(const Axis& axis) const noexcept;
  Weakest weakest(const Axis& axis) const noexcept;
  void set_top() noexcept;
  // With `room` of the joints' acceleration and the share `jerk` of their jerk.
  AxisLimits limits_of(const Axis& axis, const JointVector& room, double jerk) const noexcept;
  // Adds the steps of `axes` to `out`; what they take of the joints' acceleration.
  JointVector add(const Axes& axes, const JointVector& room, double jerk,
                  Vector6& out) const noexcept;

  const PlanLimits& limits_;
  const TipLaw law_;
  Twist way_;
  Axes place_, turn_;
  JointVector room_;  // what the curve of a straight way leaves of the joints' acceleration
};

}  // namespace handrail
