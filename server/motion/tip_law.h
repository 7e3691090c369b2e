// How the tip wants to move this cycle, from what the joints could do for it.
#pragma once

#include <algorithm>
#include <array>

#include "server/motion/stop_plan.h"

namespace handrail {

// What of the joints' limits a proposal uses.
struct TipLaw {
  double tip_speed = 1.0;    // [m/s]
  double dt = 0.0071;        // [s]
  double speed_share = 1.0;  // 0..1: of the speed, for a link that ages
};

// What place and turn may do toward their target and across that way; worked out once a cycle. Each
// as if the joints were there for it alone: where they cannot do both, the step is refused.
class TipProposal {
 public:
  TipProposal(const PlanLimits& limits, const TipSpace& space, const TipLaw& law,
              const TipMotion& from, const Pose& target) noexcept;

  // The change of the tip's step with the share 0..1 of the joints' acceleration for the place and
  // for the turn: toward the target, never beyond where it can stop. `hard`: by so much more it
  // brakes where the share turns out not to do. `faster`: false where the joints cannot do all of
  // it: a tip that also goes across its way gains no speed along it until that is braked. Real-time
  // safe.
  Twist change(double place, double turn, double hard, bool faster = true) const noexcept;

  Twist way() const noexcept { return way_; }
  // About how many cycles the straight way takes.
  double cycles() const noexcept { return std::max(cycles(place_[0]), cycles(turn_[0])); }
  // What keeps the tip from going faster, when it is not there yet.
  Verdict limiting() const noexcept;

 private:
  // One direction of the motion, a unit of metres and of radians times kTurnLength.
  struct Axis {
    Vector6 unit = Vector6::Zero();
    JointVector rate = JointVector::Zero();  // joint turns per unit, absolute
    double ahead = 0.0, step = 0.0, change = 0.0;
    double top = 1e9;  // speed beside the joints' own, a cycle
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
  double cycles(const Axis& axis) const noexcept;
  void set_top() noexcept;
  AxisLimits limits_of(const Axis& axis, double share) const noexcept;

  const PlanLimits& limits_;
  const TipLaw law_;
  Twist way_;
  Axes place_, turn_;
};

}  // namespace handrail
