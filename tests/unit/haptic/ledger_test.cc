// Where force and motion went, against the same told by the whole loop.
#include "server/haptic/ledger.h"

#include <gtest/gtest.h>

#include "tests/unit/constraint/tool_samples.h"
#include "tests/unit/haptic/loop_rig.h"

namespace handrail {
namespace {

using test::Dice;
using test::FollowRig;
using test::HapticRig;

TEST(Ledger, TheStagesLeadFromTheHandToTheArmAndTheLinksIsWhatIsOnItsWay) {
  test::LoopRig loop;
  loop.master.order(OrderKind::kEngage);
  for (int i = 0; i < 200; ++i) loop.tick();
  ASSERT_EQ(loop.master.session(), SessionState::kEngaged);
  loop.master.call(test::line_call({0, 1, 0}));
  Dice dice(11);
  test::Wander wander;
  double largest_tool = 0.0, largest_link = 0.0, largest_limits = 0.0;
  for (int i = 0; i < 4000; ++i) {
    wander.move(dice, 0.1, 0.1, 1e-3, loop.master.in.hand.X_MH);
    const SlaveState seen = loop.master.in.slave;
    loop.tick();
    if (i < 100) continue;
    const MotionLedger& ledger = loop.master.out.motion;
    ASSERT_TRUE(ledger.known);
    const Vec3 hand = loop.master.state->command.engagement.to_slave(loop.master.in.hand.X_MH).p;
    ASSERT_LT((ledger.off_S.rowwise().sum() - (seen.X_ST_command.p - hand)).norm(), 1e-12);
    const Vec3 applied = loop.sent[seen.applied_sequence].X_SU.p;
    ASSERT_LT((loop.stage(MotionStage::kLink) - (applied - loop.master.command().p)).norm(), 1e-7)
        << i;
    if (i > 3500) {
      EXPECT_EQ(ledger.why[static_cast<std::size_t>(MotionStage::kSmoother)], Reason::kNone)
          << "the tool was called long ago: smoothing";
    }
    ASSERT_LT(angle_between(ledger.q_ST, seen.X_ST_command.q), 1e-12);
    ASSERT_LT(angle_between(ledger.q_SU, loop.master.command().q), 1e-12);
    largest_tool = std::max(largest_tool, loop.stage(MotionStage::kTool).norm());
    largest_link = std::max(largest_link, loop.stage(MotionStage::kLink).norm());
    largest_limits = std::max(largest_limits, loop.stage(MotionStage::kLimits).norm());
  }
  EXPECT_GT(largest_tool, 1e-3);
  EXPECT_GT(largest_link, 1e-4);
  EXPECT_GT(largest_limits, 1e-5);
}

TEST(Ledger, AToolCalledBesideTheTipIsEasedTowardAndThenSmoothed) {
  HapticRig rig;
  rig.engage();
  ToolCall line = test::line_call({0, 1, 0});
  rig.call(test::at(line, rig.command().p + Vec3(0, 0, 0.01)));
  const auto smoother = [&] {
    return rig.out.motion.why[static_cast<std::size_t>(MotionStage::kSmoother)];
  };
  rig.ticks(50);
  EXPECT_EQ(smoother(), Reason::kToolBlending);
  rig.ticks(3000);
  for (int i = 0; i < 50; ++i) {
    rig.in.hand.X_MH.p += rig.state->command.engagement.to_hand({0, 1e-4, 0});
    rig.tick();
  }
  EXPECT_GT(rig.out.motion.off_S.col(1).norm(), 1e-4);
  EXPECT_EQ(smoother(), Reason::kNone);
}

TEST(Ledger, ATipHeldBackByContactAndByTheToolIsTheirs) {
  FollowRig rig;
  rig.engage();
  ToolDefinition tool = test::line_along(rig.tip.p, Vec3::UnitY());
  tool.epoch = 1;
  rig.in.master.position_tool = tool;
  Pose X = rig.tip;
  X.p.z() -= 0.02;
  rig.in.f_E_T.force.z() = -30.0;  // the environment pushes up
  rig.in.master_sequence = 77;
  for (int i = 0; i < 500; ++i) rig.follow(X);
  const FollowLedger& ledger = rig.out.link.ledger;
  const auto stage = [&](FollowStage s) {
    return Vec3(ledger.off_S.col(static_cast<int>(s)).cast<double>());
  };
  EXPECT_LT((stage(FollowStage::kTube) - Vec3(0, 0, 0.02)).norm(), 1e-7);
  EXPECT_EQ(ledger.why[0], Reason::kToolTube);
  EXPECT_LT((stage(FollowStage::kBumper) - Vec3(0, 0, 3e-4)).norm(), 1e-7);
  EXPECT_EQ(ledger.why[1], Reason::kBumper);
  EXPECT_LT(stage(FollowStage::kLimits).norm(), 1e-7);
  EXPECT_EQ(rig.out.link.applied_sequence, 77u);
}

TEST(Ledger, TheForcesAddUpAndEachIsWhatItsStageDid) {
  HapticRig rig;
  rig.spring_slack = false;
  rig.engage();
  Dice dice(12);
  test::Wander wander;
  for (int i = 0; i < 5000; ++i) {
    if (i == 1000) rig.call(test::line_call({0, 1, 0}));
    wander.move(dice, 0.2, 0.1, 1e-3, rig.in.hand.X_MH);
    rig.tick();
    const ForceLedger& f = rig.out.force;
    ASSERT_LT((f.tool + f.walls + f.spring + f.governor + f.limits + f.clamp + f.cue -
               rig.out.f_H_M.force)
                  .norm(),
              1e-12);
    ASSERT_EQ(f.device, rig.out.f_H_M.force);
    if (rig.out.motion.known && i < 1000) {
      ASSERT_EQ(f.tool, Vec3(Vec3::Zero()));
    }
    if (!rig.out.shares.clamped && !rig.out.shares.thermal) {
      ASSERT_LT(f.clamp.norm(), 1e-9);
    }
  }
}

TEST(Ledger, WhatThePeakTakesIsTheClampsAndWhatTheStepLimitHoldsBackTheLimits) {
  ForceLimits limits;
  limits.peak = 3.3;
  limits.continuous = 3.3;
  const auto settled = [&](const Vec3& tool, int ticks) {
    Arbiter arbiter;
    ForceShares shares;
    for (int i = 0; i < ticks; ++i) {
      shares = arbiter.share(limits, tool, Vec3::Zero(), 0.0, Trust::kBoth, 1e-3);
    }
    return account(shares, tool, Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero());
  };
  const ForceLedger over = settled({0, 5, 0}, 5000);
  EXPECT_NEAR(over.clamp.y(), 3.3 - 5.0, 1e-9);
  EXPECT_LT(over.limits.norm(), 1e-9);
  const ForceLedger begun = settled({0, 2, 0}, 1);
  EXPECT_EQ(begun.clamp, Vec3(Vec3::Zero()));
  EXPECT_LT(begun.limits.y(), -1.0);
  EXPECT_NEAR(begun.limits.y(), begun.device.y() - 2.0, 1e-12);
}

}  // namespace
}  // namespace handrail
