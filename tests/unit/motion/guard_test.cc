#include "server/motion/guard.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/arm_samples.h"
#include "tests/unit/motion/joint_watch.h"

namespace handrail {
namespace {

constexpr double kDt = 0.0071;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

JointVector home() { return test::joints_deg(0, 0, 90, 0, 90, 0); }
GuardLimits limits(const Workspace& workspace = Workspace()) {
  return {rv2a_limits(), ArmGeometry(), workspace, kDt};
}
GuardState at(const JointVector& q) {
  GuardState s;
  s.q = q;
  return s;
}
JointVector top_step() { return rv2a_limits().max_speed * kDt; }
JointVector top_change() { return rv2a_limits().max_acceleration * (kDt * kDt); }
JointVector top_jerk() { return rv2a_limits().max_jerk * (kDt * kDt * kDt); }

TEST(Guard, LetsWhatIsWithinTheLimitsPassBitForBit) {
  GuardState state = at(home());
  const JointVector wanted = home() + 0.99 * top_jerk();
  EXPECT_EQ(guard(limits(), state, wanted).reason, Reason::kNone);
  EXPECT_EQ(state.q, wanted);
  EXPECT_EQ(state.step, wanted - home());
  EXPECT_EQ(state.change, wanted - home());
}

TEST(Guard, NamesTheCheckAndTheJointThatACommandFails) {
  const struct {
    Reason reason;
    JointVector step, change;  // where the commands stand
    double more;               // of J3's step
  } cases[] = {
      {Reason::kJointJerk, JointVector::Zero(), JointVector::Zero(), 1.01 * top_jerk()[2]},
      {Reason::kJointAcceleration, 0.5 * top_step(), JointVector(0.99 * top_change()),
       1.01 * top_change()[2]},
      {Reason::kJointSpeed, JointVector(0.999 * top_step()), JointVector::Zero(),
       0.5 * top_jerk()[2]},
  };
  for (const auto& c : cases) {
    GuardState state = at(home());
    state.step = c.step;
    state.change = c.change;
    JointVector wanted = home() + c.step;
    wanted[2] += c.more;
    // The other joints slow gently, so that only J3 is to blame.
    for (const int i : {0, 1, 3, 4, 5}) {
      wanted[i] += c.change[i] - 0.5 * (c.change[i] > 0.0 ? top_jerk()[i] : 0.0);
    }
    const Verdict verdict = guard(limits(), state, wanted);
    EXPECT_EQ(verdict.reason, c.reason) << describe(verdict.reason);
    EXPECT_EQ(verdict.joint, 2) << describe(c.reason);
  }
  GuardState state = at(home());
  state.q[4] = rv2a_limits().upper[4] - 1e-6;
  JointVector wanted = state.q;
  wanted[4] += 1e-5;
  const Verdict verdict = guard(limits(), state, wanted);
  EXPECT_EQ(verdict.reason, Reason::kJointRange);
  EXPECT_EQ(verdict.joint, 4);
}

TEST(Guard, ARefusedCommandIsOneCycleOfStopping) {
  GuardState state = at(home());
  state.step = 0.5 * top_step();
  GuardState stopping = state;
  guard_brake(limits(), stopping);
  EXPECT_EQ(guard(limits(), state, test::joints_deg(90, 90, 60, 90, 0, 90)).reason,
            Reason::kJointRange);
  EXPECT_EQ(state.q, stopping.q);
  EXPECT_LT(state.step.norm(), 0.5 * top_step().norm());
}

TEST(Guard, WhatIsNotANumberBrakes) {
  for (const double bad : {kNaN, std::numeric_limits<double>::infinity(), -1e308}) {
    for (int joint = 0; joint < kJoints; ++joint) {
      GuardState state = at(home());
      state.step = 0.5 * top_step();
      JointVector wanted = home() + state.step;
      wanted[joint] = bad;
      EXPECT_EQ(guard(limits(), state, wanted).reason, Reason::kCommandInvalid);
      ASSERT_TRUE(state.q.allFinite());
      EXPECT_LT(state.step.norm(), 0.5 * top_step().norm());
    }
  }
}

TEST(Guard, ATipAtTheEndOfTheWorkspaceStopsInsideAndMayComeBack) {
  Workspace workspace;
  workspace.high.y() = 0.1;
  const GuardLimits l = limits(workspace);
  GuardState state = at(home());
  bool refused = false;
  for (int i = 0; i < 300; ++i) {
    JointVector wanted = state.q + state.step;
    wanted[0] += std::min(0.9 * top_jerk()[0], 0.02 * top_step()[0]);
    refused |= guard(l, state, wanted).reason == Reason::kWorkspace;
    ASSERT_LE(forward(l.arm, state.q).p.y(), 0.1);
  }
  EXPECT_TRUE(refused);
  while (!state.step.isZero(0.0)) guard_brake(l, state);
  JointVector back = state.q;
  back[0] -= 0.5 * top_jerk()[0];
  EXPECT_EQ(guard(l, state, back).reason, Reason::kNone);
}

// J1 turns the stretched arm as fast as it may, straight at a face that it meets at full speed.
TEST(Guard, ATipAtFullSpeedStopsInsideTheWorkspace) {
  Workspace workspace;
  workspace.high.y() = 0.3;
  const GuardLimits l = limits(workspace);
  GuardState state = at(test::joints_deg(-80, 70, 20, 0, 0, 0));
  double fastest = 0.0, furthest = -1.0;
  for (int i = 0; i < 400; ++i) {
    JointVector wanted = state.q + state.step;
    const double faster = std::min(0.99 * l.acceleration[0], state.change[0] + 0.99 * l.jerk[0]);
    const double slack = 0.98 * l.speed[0] - state.step[0];
    wanted[0] += std::min(faster, std::max(slack, state.change[0] - 0.99 * l.jerk[0]));
    guard(l, state, wanted);
    fastest = std::max(fastest, state.step[0]);
    furthest = std::max(furthest, forward(l.arm, state.q).p.y());
    ASSERT_LE(furthest, 0.3) << i;
  }
  EXPECT_GT(fastest, 0.8 * l.speed[0]);
  EXPECT_GT(furthest, 0.25);
}

// The lever bounds how far a joint takes the tip, wherever that is mounted.
TEST(Guard, NoJointTakesTheTipFurtherThanItsLever) {
  std::mt19937_64 random(31);
  for (const bool mounted : {false, true}) {
    ArmGeometry arm;
    if (mounted) arm.X_AT = Pose{Vec3(0.1, -0.05, 0.25), rotation_exp(Vec3(0.3, 0.9, -0.4))};
    const GuardLimits l(rv2a_limits(), arm, Workspace(), 0.0071);
    EXPECT_EQ(l.lever[5] > 0.0, mounted);
    for (int run = 0; run < 2000; ++run) {
      const JointVector q = test::random_joints(random);
      JointVector by = 0.02 * (test::random_joints(random) - q);
      const double moved = (forward(arm, q + by).p - forward(arm, q).p).norm();
      ASSERT_LE(moved, l.lever.dot(by.cwiseAbs()) + 1e-12);
    }
  }
}

TEST(Guard, AJointFoundOutsideItsRangeMayOnlyComeBack) {
  JointVector outside = home();
  outside[2] = rv2a_limits().upper[2] + 0.01;
  JointVector further = outside, back = outside;
  further[2] += 1e-5;
  back[2] -= 1e-5;
  EXPECT_EQ(guard_allows(limits(), at(outside), further).reason, Reason::kJointRange);
  EXPECT_EQ(guard_allows(limits(), at(outside), outside).reason, Reason::kNone);
  EXPECT_EQ(guard_allows(limits(), at(outside), back).reason, Reason::kNone);
}

}  // namespace
}  // namespace handrail
