// The slave's last functions under hostile targets: whatever is asked, joints stay within speed,
// acceleration and range.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <limits>

#include "server/control/guard.h"
#include "tests/unit/control/follow_rig.h"

namespace handrail {
namespace {

using test::FollowRig;
using test::LimitWatch;

// Below `n`, at full size: the default starts with the low ends of all ranges.
int below(int n) { return *rc::gen::resize(rc::kNominalSize, rc::gen::inRange(0, n)); }

double between(double low, double high) {
  constexpr int kSteps = 1'000'000;
  return low + (high - low) * below(kSteps + 1) / kSteps;
}

Vec3 within(double size) {
  return {between(-size, size), between(-size, size), between(-size, size)};
}

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
    case 1:
      X = forward(ArmGeometry(), any_joints(1.0));
      break;
    case 2:
      X = {within(2.0), rotation_exp(within(3.0))};
      break;
    case 3:
      X.p[below(3)] = odd_number();
      break;
    case 4:
      X.q.coeffs()[below(4)] = odd_number();
      break;
    default:
      X.p += within(1e-4);
  }
  return X;
}

RC_GTEST_PROP(GuardProperty, WhateverIsWantedTheNextJointsAreWithinEveryLimit, ()) {
  constexpr double kDt = 0.0071;
  const JointLimits& limits = rv2a_limits();
  JointVector q = any_joints(1.0), last = JointVector::Zero(), before = q;
  LimitWatch watch;
  const int cycles = 50 + below(150);
  for (int i = 0; i < cycles; ++i) {
    JointVector wanted = any_joints(1.0);
    if (below(10) == 0) wanted[below(kJoints)] = odd_number();
    const Guarded out = guard(limits, q, last, wanted, kDt);
    watch.see(limits, kDt, before, q, out.q);
    RC_ASSERT(watch.kept());
    RC_ASSERT((out.reason == Reason::kNone) == (out.q == wanted));
    before = q;
    last = out.q - q;
    q = out.q;
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
