// The slave's last functions under hostile targets: whatever is asked, joints stay within speed,
// acceleration and range.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <limits>

#include "server/base/random.h"
#include "server/motion/guard.h"
#include "tests/property/draws.h"
#include "tests/unit/follow/follow_rig.h"

namespace handrail {
namespace {

using test::below;
using test::between;
using test::within;

using test::FollowRig;

JointVector any_joints(double share) {
  const JointLimits& limits = rv2a_limits();
  JointVector q;
  for (int i = 0; i < kJoints; ++i) q[i] = between(limits.lower[i], limits.upper[i]);
  return (1.0 - share) * test::home() + share * q;
}

double odd_number() {
  return *rc::gen::element(std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity(), 1e308, -1e200, 1e-310, 0.0);
}

// Near, far, out of reach, turned, or no pose at all.
Pose any_target(const Pose& here) {
  Pose X = here;
  switch (below(6)) {
    case 0:
      X.p += within(0.05);
      X.q = (rotation_exp(within(0.3)) * X.q).normalized();
      break;
    case 1: X = forward(ArmGeometry(), any_joints(1.0)); break;
    case 2: X = {within(2.0), rotation_exp(within(3.0))}; break;
    case 3: X.p[below(3)] = odd_number(); break;
    case 4: X.q.coeffs()[below(4)] = odd_number(); break;
    default: X.p += within(1e-4);
  }
  return X;
}

// Commands made to break what the guard keeps: jumps, ends of ranges, edges of each limit, no
// numbers.
double hostile(int kind, const GuardLimits& limits, const GuardState& s, int i, Random& random) {
  const AxisLimits& l = limits.axis[static_cast<std::size_t>(i)];
  const double u = random.uniform(), on = s.q[i] + s.step[i];
  switch (kind) {
    case 0: return s.q[i] + 0.3 * random.normal();
    case 1: return limits.lower[i] + u * (limits.upper[i] - limits.lower[i]);
    case 2: return u < 0.5 ? 1e9 : -1e9;
    case 3: return u < 0.1 ? std::numeric_limits<double>::quiet_NaN() : on;
    case 4: return limits.upper[i] + 1e-3 * (u - 0.5);
    case 5: return limits.lower[i];
    case 6: return on + s.change[i] + 1.2 * (2.0 * u - 1.0) * l.jerk;
    case 7: return u < 0.01 ? 1e308 : s.q[i] + (i % 2 == 0 ? l.speed : -l.speed);
    case 8: return on + (u < 0.5 ? l.acceleration : -l.acceleration);
    default: return on + 2.2 * (u - 0.5) * l.acceleration;
  }
}

// 10^6 commands. The workspace's faces cut through where the tip goes.
TEST(GuardProperty, AMillionHostileCommandsNeverBreakALimitAndStopsEndInTime) {
  constexpr double kDt = 0.0071;
  Random random(7);
  const ArmGeometry arm;
  for (const double jerk_time : {0.01, 0.02, 0.05}) {
    JointLimits joints = rv2a_limits();
    joints.max_jerk = joints.max_acceleration / jerk_time;
    Workspace workspace;
    workspace.high = Vec3(0.9, 0.5, 1.0);
    const GuardLimits limits(joints, arm, workspace, kDt);
    GuardState state;
    state.q = test::home();
    test::JointWatch watch;
    watch.see(joints, kDt, state.q);
    int kind = 0, left = 0, passed = 0;
    double outside = -1.0, late = -1e9;
    for (int k = 0; k < 333'334; ++k) {
      if (left-- <= 0) {
        kind = static_cast<int>(10.0 * random.uniform());
        left = static_cast<int>(60.0 * random.uniform());
        // A stop from here.
        double bound = 0.0;
        for (std::size_t i = 0; i < kJoints; ++i) {
          const AxisLimits& l = limits.axis[i];
          bound = std::max(bound, std::abs(state.step[static_cast<int>(i)]) / l.acceleration +
                                      2.5 * l.acceleration / l.jerk);
        }
        GuardState stopping = state;
        int cycles = 0;
        do {
          guard_brake(limits, stopping);
          ++cycles;
        } while (!stopping.step.isZero(0.0) && cycles < 300);
        late = std::max(late, cycles - 1 - bound);
      }
      JointVector wanted;
      for (int i = 0; i < kJoints; ++i) wanted[i] = hostile(kind, limits, state, i, random);
      const Verdict verdict = guard(limits, state, wanted);
      passed += verdict.reason == Reason::kNone;
      ASSERT_EQ(verdict.reason == Reason::kNone, state.q == wanted);
      watch.see(joints, kDt, state.q);
      const Vec3 p = forward(arm, state.q).p;
      outside =
          std::max({outside, (p - workspace.high).maxCoeff(), (workspace.low - p).maxCoeff()});
    }
    EXPECT_TRUE(watch.kept()) << jerk_time;
    EXPECT_LE(outside, 0.0);
    EXPECT_LT(late, 1.0);
    EXPECT_GT(passed, 10'000);
  }
}

// 100 runs of 100 to 300 cycles and more: over 10^4 cycles. The guard behind is never needed.
RC_GTEST_PROP(GuardProperty, HostileTargetsEveryCycleNeverBreakALimitNorNeedTheGuard, ()) {
  FollowRig rig(any_joints(0.9));
  rig.engage();
  const int cycles = 100 + below(200);
  for (int i = 0; i < cycles; ++i) {
    const Pose target = any_target(rig.state.motion.X_ST);
    const int repeats = 1 + below(9);
    rig.in.master.X_SU = target;
    rig.in.master_age = *rc::gen::element<Nanos>(0, 0, 0, 8 * kMillisecond, 30 * kMillisecond);
    for (int k = 0; k < repeats; ++k) {
      rig.cycle();
      RC_ASSERT(rig.watch.kept());
      RC_ASSERT(rig.guarded == 0);
      RC_ASSERT(is_finite(rig.out.link.X_ST_command));
    }
  }
}

RC_GTEST_PROP(GuardProperty, TheJointsSentAreTheTipSaid, ()) {
  FollowRig rig(any_joints(0.8));
  rig.engage();
  for (int i = 0; i < 60; ++i) {
    if (i % 15 == 0) rig.in.master.X_SU = any_target(rig.state.motion.X_ST);
    rig.cycle();
    RC_ASSERT(test::position_error(rig.tip, rig.out.link.X_ST_command) < 1e-9);
    RC_ASSERT(test::rotation_error(rig.tip, rig.out.link.X_ST_command) < 1e-8);
  }
}

}  // namespace
}  // namespace handrail
