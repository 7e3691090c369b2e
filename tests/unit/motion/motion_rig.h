// The planner with the guard behind it, without a slave around them, for tests.
#pragma once

#include <algorithm>

#include "server/base/random.h"
#include "server/base/units.h"
#include "server/motion/tip_motion.h"
#include "tests/support/arm_samples.h"
#include "tests/unit/motion/joint_watch.h"

namespace handrail::test {

inline const JointVector kHome = joints_deg(0, 0, 90, 0, 90, 0);

struct MotionRig {
  MotionSettings settings;
  MotionState state;
  TipSpace space;
  JointWatch watch;
  Verdict verdict;         // of the planner
  int guarded = 0;         // cycles in which the guard had to act
  int frozen = 0;          // cycles in which no joint moved: the most in a row
  double off_space = 0.0;  // the worst [m]
  double off_rest = 0.0;  // the place that a plan says it ends at from where it does, the worst [m]

  explicit MotionRig(const JointVector& q, const ArmGeometry& arm = {}) {
    settings.arm = arm;
    state = standing_at(settings.arm, q);
    watch.see(settings.limits, settings.dt, q);
  }
  ArmMotion motion() const { return settings; }
  void follow(const Pose& target, double share = 1.0) {
    const Moved moved = move_toward(motion(), space, target, share, state);
    verdict = moved.reach.reason != Reason::kNone ? moved.reach : moved.limit;
    finish(moved.next);
  }
  void stop() { finish(brake(motion(), state)); }
  // Cycles in which a stop from here moves any joint.
  int cycles_to_stop() const {
    MotionRig copy = *this;
    int cycles = 0;
    do {
      copy.stop();
      ++cycles;
    } while (!copy.state.joints.step.isZero(1e-9) && cycles < 300);
    return copy.guarded > guarded || !copy.watch.kept() || copy.off_space > 1e-8 ? 1000
                                                                                 : cycles - 1;
  }
  // v/a + 2.5 a/j of the slowest-stopping joint, a/j two cycles at least, in cycles.
  double stop_bound() const {
    double cycles = 0.0;
    for (int i = 0; i < kJoints; ++i) {
      const double a = settings.limits.max_acceleration[i], j = settings.limits.max_jerk[i];
      const double bend = std::max(a / j, 2.0 * settings.dt);
      cycles = std::max(
          cycles, (std::abs(state.joints.step[i]) / settings.dt / a + 2.5 * bend) / settings.dt);
    }
    return cycles;
  }

 private:
  void finish(const TipMotion& decided) {
    guarded += command(motion(), decided, state).reason != Reason::kNone;
    watch.see(settings.limits, settings.dt, state.joints.q);
    still_ = state.joints.step.isZero(1e-7) ? still_ + 1 : 0;
    frozen = std::max(frozen, still_);
    const StopPlan& stop = state.stop;
    if (!stop.done()) {
      const JointVector& last = stop.q[static_cast<std::size_t>(stop.size - 1)];
      off_rest = std::max(off_rest, (rest_place(state) - forward(settings.arm, last).p).norm());
    }
    off_space = std::max(off_space, space.distance(forward(settings.arm, state.joints.q).p));
  }

  int still_ = 0;
};

inline double between(Random& random, double low, double high) {
  return low + (high - low) * random.uniform();
}
inline Vec3 normal(Random& random) { return {random.normal(), random.normal(), random.normal()}; }

}  // namespace handrail::test
