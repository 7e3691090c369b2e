#include "server/control/joint_brake.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "server/base/random.h"
#include "server/base/rv2a_limits.h"
#include "server/base/units.h"

namespace handrail {
namespace {

MotionSettings settings() {
  MotionSettings s;
  s.limits = rv2a_limits();
  return s;
}

double between(Random& random, double low, double high) {
  return low + (high - low) * random.uniform();
}

double off_line(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 u = (b - a).normalized();
  return ((p - a) - (p - a).dot(u) * u).norm();
}

// From a little to one side of J5 = 0 to the other, past it rather than through it.
TEST(JointBrake, ATipThatPassesBesideASingularPoseStaysOnItsLine) {
  Random random(7);
  const MotionSettings s = settings();
  double worst = 0.0;
  for (int run = 0; run < 400; ++run) {
    JointVector from;
    from << between(random, -60, 60), between(random, 10, 60), between(random, 70, 120), 0.0,
        between(random, 5, 25), 0.0;
    JointVector to = from;
    to[0] += between(random, -8, 8);
    to[1] += between(random, -8, 8);
    to[2] += between(random, -8, 8);
    to[3] = between(random, -1, 1);
    to[4] = -from[4];
    const Pose target = forward(s.arm, to * kDeg);
    MotionState state = standing_at(s.arm, from * kDeg);
    const Vec3 start = state.X_ST.p;
    for (int cycle = 0; cycle < 300; ++cycle) {
      (void)move_toward(s, target, 1.0, state);
      worst = std::max(worst, off_line(forward(s.arm, state.q).p, start, target.p));
    }
  }
  EXPECT_LT(worst, 1e-5);
}

TEST(JointBrake, StaysInTheBoxWhateverTheLastStepWas) {
  Random random(11);
  const MotionSettings s = settings();
  for (int run = 0; run < 2000; ++run) {
    MotionState state = standing_at(s.arm, JointVector::Zero());
    for (int i = 0; i < kJoints; ++i) {
      state.q[i] = between(random, s.limits.lower[i], s.limits.upper[i]);
      state.step[i] = between(random, -1.0, 1.0) * s.limits.max_speed[i] * s.dt;
    }
    state.X_ST = forward(s.arm, state.q);
    state.tip_step.linear = Vec3(random.normal(), random.normal(), random.normal()) * 1e-3;
    const StepBox box = step_box(s.limits, state.q, state.step, s.dt, 1.0, 1.0);
    EXPECT_TRUE(box.contains(joint_brake(s, state, box)));
  }
}

TEST(JointBrake, AnArmAtRestStaysAtRest) {
  const MotionSettings s = settings();
  const MotionState state = standing_at(s.arm, JointVector::Constant(0.9));
  const StepBox box = step_box(s.limits, state.q, state.step, s.dt, 1.0, 1.0);
  EXPECT_TRUE(joint_brake(s, state, box).isZero(0.0));
}

}  // namespace
}  // namespace handrail
