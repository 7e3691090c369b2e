// The master's own step of walls, with and without a governor.
#pragma once

#include <memory>

#include "server/haptic/wall_step.h"
#include "server/stability/energy_governor.h"

namespace handrail {

class GovernedWalls {
 public:
  // `run`: from make_wall_run, not null.
  GovernedWalls(std::unique_ptr<WallRun> run, const GovernorSettings& governor)
      : run_(std::move(run)), settings_(governor) {}

  // One tick: the force of the device until the next, in M's X and Y [N]. `dt` > 0 since the last
  // [s].
  Vec2 step(const HandReading& hand, double dt) noexcept;

  // What of the change since the last tick the hand's motion explains, of what the arbiter lets
  // pass, and what the arbiter lets pass beside it [N].
  double explained() const noexcept { return explained_; }
  double spare_step() const noexcept { return run_->settings.force.step; }

 private:
  double stiffness() const noexcept;
  Vec3 governed(const HandReading& hand, double dt) noexcept;

  std::unique_ptr<WallRun> run_;
  GovernorSettings settings_;
  EnergyGovernor governor_;
  WallOutput out_;
  Vec3 last_ = Vec3::Zero();  // reading [m]
  bool started_ = false;
  double explained_ = 0.0;
};

}  // namespace handrail
