// The master's own step, engaged, with an arm that is where it is told to be.
#pragma once

#include <algorithm>
#include <memory>
#include <numbers>

#include "server/haptic/haptic_step.h"
#include "server/lab/sequences/played_slave.h"

namespace handrail {

class EngagedStep {
 public:
  // The hand is at M's origin.
  explicit EngagedStep(const HapticSettings& settings) : settings_(settings) {
    in_.hand.valid = true;
    in_.slave = played_slave(kStart);
    in_.slave_known = true;
    in_.slave_age = 0;
    step();  // says which scene and settings the slave has to share
    in_.order.kind = OrderKind::kEngage;
    for (int i = 0; i < kEngages; ++i) step();
  }

  void call(const ToolCall& tool) {
    in_.order.kind = OrderKind::kTool;
    in_.order.tool = tool;
    step();
  }
  // From now on the slave tells of it, and it holds the tip.
  void touch(const Surface& surface) { in_.slave.surface = surface; }
  // A tick with the hand there, `dt` after the one before [s], and what is asked for until the
  // next.
  Wrench step(const Pose& X_MH, const Vec3& v_MH, double dt) {
    in_.hand.X_MH = X_MH;
    in_.hand.v_MH = v_MH;
    step(dt);
    return out_.f_H_M;
  }

  double period() const noexcept { return settings_.governor.period; }  // [s]
  bool engaged() const noexcept { return out_.link.state == SessionState::kEngaged; }
  const HapticSettings& settings() const noexcept { return settings_; }
  const HapticState& state() const noexcept { return *state_; }

  static inline const Pose kStart{{0.35, 0.05, 0.43}, rotation_exp({std::numbers::pi, 0.0, 0.0})};

 private:
  static constexpr int kEngages = 6;  // ticks until master and slave have answered each other

  void step() { step(period()); }
  void step(double dt) {
    haptic_step(settings_, in_, dt, *state_, out_);
    in_.order = HapticOrder();
    play_slave(out_.link, in_.slave);
    if (!in_.slave.surface) return;
    Vec3& tip = in_.slave.X_ST.p;
    tip -= std::min(in_.slave.surface->out_of(tip), 0.0) * in_.slave.surface->n_S;
  }

  HapticSettings settings_;
  std::unique_ptr<HapticState> state_ = std::make_unique<HapticState>();
  HapticInput in_;
  HapticOutput out_;
};

}  // namespace handrail
