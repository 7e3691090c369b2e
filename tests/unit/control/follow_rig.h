// A slave's step with a master played beside it, for tests: cycles of 7.1 ms, the arm where it was
// told to be, and a watch on every joint step.
#pragma once

#include <algorithm>
#include <cmath>

#include "server/control/follow_step.h"
#include "tests/support/arm_samples.h"

namespace handrail::test {

// Greatest share of a limit that any step has taken; 1 is the limit itself.
struct LimitWatch {
  double speed = 0.0;
  double acceleration = 0.0;
  double range = -1e9;  // how far beyond the range [rad]; negative inside
  bool finite = true;

  bool kept() const { return finite && speed <= kFull && acceleration <= kFull && range <= 1e-9; }

  void see(const JointLimits& limits, double dt, const JointVector& before_last,
           const JointVector& last, const JointVector& now) {
    finite = finite && now.allFinite();
    const JointVector step = now - last, change = step - (last - before_last);
    for (int i = 0; i < kJoints; ++i) {
      speed = std::max(speed, std::abs(step[i]) / (limits.max_speed[i] * dt));
      acceleration =
          std::max(acceleration, std::abs(change[i]) / (limits.max_acceleration[i] * dt * dt));
      range = std::max({range, now[i] - limits.upper[i], limits.lower[i] - now[i]});
    }
  }

 private:
  static constexpr double kFull = 1.0 + 1e-9;
};

inline JointVector home() { return joints_deg(0, 0, 90, 0, 90, 0); }

class FollowRig {
 public:
  explicit FollowRig(const JointVector& q = home()) {
    settings.motion.limits = rv2a_limits();
    in.robot_ready = true;
    in.q_measured = before_ = last_ = q;
    in.wrench_valid = true;
    place(settings, q, state);
  }

  // One cycle with what `in` says.
  void cycle() {
    follow_step(settings, in, state, out);
    watch.see(settings.motion.limits, settings.motion.dt, before_, last_, out.q_target);
    guarded += out.link.reason == Reason::kGuard ? 1 : 0;
    before_ = last_;
    last_ = in.q_measured = out.q_target;
    tip = forward(settings.motion.arm, out.q_target);
  }

  // Plays the master until the slave is engaged, standing.
  void engage() {
    in.master_known = true;
    in.master_age = 0;
    in.master.desired = Desired::kEngaged;
    in.master.state = SessionState::kAligning;
    in.master.has_command = true;
    in.master.X_SU = state.motion.X_ST;
    cycle();
    cycle();
    in.master.state = SessionState::kEngaged;
    cycle();
  }

  // One cycle toward `X_SU` by a fresh command.
  void follow(const Pose& X_SU) {
    in.master.X_SU = X_SU;
    in.master_age = 0;
    cycle();
  }

  const JointVector& joints() const { return last_; }

  FollowSettings settings;
  FollowState state;
  FollowInput in;
  FollowOutput out;
  LimitWatch watch;
  int guarded = 0;  // cycles in which the guard had to act
  Pose tip;         // forward kinematics of the newest target

 private:
  JointVector before_, last_;
};

}  // namespace handrail::test
