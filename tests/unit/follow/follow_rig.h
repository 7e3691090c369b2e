// A slave's step with a master played beside it, for tests: cycles of 7.1 ms, the arm where it was
// told to be, and a watch on every joint step.
#pragma once

#include "server/follow/follow_step.h"
#include "tests/support/arm_samples.h"
#include "tests/unit/motion/joint_watch.h"

namespace handrail::test {

inline JointVector home() { return joints_deg(0, 0, 90, 0, 90, 0); }

class FollowRig {
 public:
  explicit FollowRig(const JointVector& q = home()) {
    in.robot_ready = true;
    in.q_measured = in.q_commanded = last_ = q;
    in.wrench_valid = true;
    place(settings, q, state);
    watch.see(settings.motion->limits, settings.motion->dt, q);
  }

  // One cycle with what `in` says.
  void cycle() {
    follow_step(settings, in, state, out);
    watch.see(settings.motion->limits, settings.motion->dt, out.q_target);
    guarded = static_cast<int>(state.guarded);
    last_ = in.q_measured = in.q_commanded = out.q_target;
    tip = forward(settings.motion->arm, out.q_target);
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
  JointWatch watch;
  int guarded = 0;  // cycles in which the guard had to act
  Pose tip;         // forward kinematics of the newest target

 private:
  JointVector last_;
};

}  // namespace handrail::test
