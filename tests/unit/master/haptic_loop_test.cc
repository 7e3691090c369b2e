// The haptic loop against a scripted device, under a manual clock.
#include "server/master/haptic_loop.h"

#include <gtest/gtest.h>

#include <memory>

#include "tests/support/no_allocation.h"
#include "tests/unit/master/loop_bench.h"

namespace handrail {
namespace {

class HapticLoopTest : public LoopBench {};

TEST_F(HapticLoopTest, ReadsTheDeviceOnceATickAndWritesWhatItReports) {
  pull_off_a_line();
  EXPECT_EQ(device.read_at, now);
  EXPECT_EQ(device.reads, static_cast<int>(report.ticks));
  EXPECT_EQ(device.writes, device.reads);
  EXPECT_EQ(device.written.force, report.out.f_H_M.force);
  EXPECT_EQ(report.X_MH.p, device.sample.X_MH.p);
}

TEST_F(HapticLoopTest, TellsTheDeviceEachTickWhatIsToBeFelt) {
  engage();
  EXPECT_EQ(device.feels, device.writes);
  EXPECT_EQ(device.felt, HapticCue{});
  news.state.has_wrench = true;
  news.state.f_E_S.force = Vec3(0.0, 0.0, 6.0);
  tick();
  EXPECT_EQ(device.felt, (HapticCue{Felt::kContact, 0.5}));
  slave_talks = false;
  ticks(150);
  EXPECT_EQ(device.felt.what, Felt::kHold) << "the link pauses";
  EXPECT_EQ(device.feels, device.writes);
}

TEST_F(HapticLoopTest, WhatItReportsStandsForTwentyMilliseconds) {
  tick();
  EXPECT_EQ(report.good_until, now + 20 * kMillisecond);
  EXPECT_EQ(report.sent_until, now + 2 * kMillisecond);
}

TEST_F(HapticLoopTest, AnswersEveryOrderByItsIdAndTakesOneATick) {
  push(7, OrderKind::kDisengage);
  push(9, OrderKind::kReset);
  push(8, OrderKind::kEngage);
  EXPECT_FALSE(boxes.doorbell.answer());
  tick();
  EXPECT_TRUE(boxes.doorbell.answer());
  EXPECT_EQ(answer(7), Reason::kNone);
  EXPECT_EQ(answer(9), std::nullopt);
  tick();
  EXPECT_EQ(answer(9), Reason::kNotStopped);
  tick();
  EXPECT_EQ(answer(8), Reason::kNone);
  EXPECT_TRUE(boxes.doorbell.answer());
  tick();
  EXPECT_FALSE(boxes.doorbell.answer());
}

TEST_F(HapticLoopTest, AnAnswerToAToolCallSaysHowFarTheToolIs) {
  engage();
  OrderTicket far;
  far.id = 2;
  far.order.kind = OrderKind::kTool;
  far.order.tool.kind = ToolKind::kPoint;
  far.order.tool.at_present = false;
  far.order.tool.p_SA = report.out.link.X_SU.p + Vec3(0.3, 0, 0.4);
  ASSERT_TRUE(boxes.orders.push(far));
  tick();
  OrderAnswer next;
  ASSERT_TRUE(boxes.answers.pop(next));
  EXPECT_EQ(next.result, Reason::kToolFar);
  EXPECT_NEAR(next.tool_distance, 0.5, 1e-9);
}

TEST_F(HapticLoopTest, OrdersForTheHandGoThereAndTheNextOrderIsNotDelayed) {
  OrderTicket wave;
  wave.is_hand = true;
  for (const std::uint64_t id : {3u, 4u}) {
    wave.id = id;
    wave.hand.displacement_M.x() = 0.01 * static_cast<double>(id);
    ASSERT_TRUE(boxes.orders.push(wave));
  }
  push(5, OrderKind::kDisengage);
  device.its_hand.is_moving = true;
  tick();
  EXPECT_EQ(answer(3), Reason::kNone);
  EXPECT_EQ(answer(4), Reason::kNone);
  EXPECT_EQ(answer(5), Reason::kNone);
  EXPECT_EQ(device.its_hand.orders, 2);
  EXPECT_EQ(device.its_hand.last.displacement_M.x(), 0.04);
  EXPECT_TRUE(report.hand_moving);
  device.its_hand.is_moving = false;
  EXPECT_FALSE(tick().hand_moving);
}

TEST_F(HapticLoopTest, RefusesOrdersForAHandThatIsNotThere) {
  device.has_hand = false;
  OrderTicket wave;
  wave.id = 3;
  wave.is_hand = true;
  ASSERT_TRUE(boxes.orders.push(wave));
  EXPECT_FALSE(tick().hand_moving);
  EXPECT_EQ(answer(3), Reason::kNotSimulated);
}

TEST_F(HapticLoopTest, AnotherSceneWaitsUntilTheSessionIsOff) {
  engage();
  HapticSettings other = settings;
  other.scene = scene_name("second");
  boxes.scene.publish({other});
  tick();
  EXPECT_TRUE(report.scene_pending);
  EXPECT_EQ(report.scene_epoch, 0u);
  ticks(50);
  EXPECT_EQ(text_of(report.out.link.scene), "first");
  EXPECT_EQ(report.out.link.state, SessionState::kEngaged);
  push(2, OrderKind::kDisengage);
  ticks(2);
  EXPECT_FALSE(report.scene_pending);
  EXPECT_EQ(report.scene_epoch, 1u);
  EXPECT_EQ(text_of(report.out.link.scene), "second");
}

TEST_F(HapticLoopTest, StopDisengagesAtOnceAndFinishesAfterTheFarewell) {
  pull_off_a_line();
  loop->request_stop();
  tick();
  EXPECT_EQ(report.out.link.desired, Desired::kOff);
  EXPECT_EQ(report.out.link.state, SessionState::kOff);
  ticks(150);
  EXPECT_FALSE(loop->finished());
  EXPECT_EQ(device.written.force.norm(), 0.0);
  tick();
  EXPECT_TRUE(loop->finished());
}

TEST_F(HapticLoopTest, NoOrderEngagesWhileStopping) {
  loop->request_stop();
  push(4, OrderKind::kEngage);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(tick().out.link.desired, Desired::kOff);
}

TEST_F(HapticLoopTest, AStallIsOneTickOfBoundedLength) {
  pull_off_a_line();
  const double before = report.out.f_H_M.force.norm();
  const std::uint64_t ticks_before = report.ticks;
  slave_talks = false;  // its news is old after the stall: force starts to leave, over 50 ms
  tick(45 * kMillisecond);
  EXPECT_EQ(report.ticks, ticks_before + 1);
  EXPECT_EQ(report.overruns, 1u);
  EXPECT_EQ(loop->due(), now + kMillisecond);
  EXPECT_EQ(report.out.link.state, SessionState::kHold);
  EXPECT_GT(report.out.f_H_M.force.norm(), 0.5 * before);
  EXPECT_LT(report.out.f_H_M.force.norm(), before);
}

TEST_F(HapticLoopTest, AfterAStallInWhichTheDeviceHasLetGoTheForceBeginsAnew) {
  for (const Nanos stall : {49 * kMillisecond, 50 * kMillisecond}) {
    if (stall == 49 * kMillisecond) pull_off_a_line();
    const double before = report.out.f_H_M.force.norm();
    ASSERT_GT(before, 0.5);
    tick(stall);
    const double after = device.written.force.norm();
    if (stall < kForceStands) {
      // What the slave said is as old as the stall: a hold of one tick, in which force begins to
      // go.
      EXPECT_GT(after, 0.5 * before);
      EXPECT_LT(after, before);
    } else {
      EXPECT_LE(after, 0.25 + 1e-9) << "five milliseconds of the step limit";
      ticks(50);
      EXPECT_GT(device.written.force.norm(), 0.5) << "and comes back";
    }
  }
}

TEST_F(HapticLoopTest, ATrembleThatTheDeviceHasLetGoOfDoesNotGoOn) {
  engage();
  constexpr auto kLimits = static_cast<std::size_t>(FollowStage::kLimits);
  news.state.ledger.off_S.col(kLimits) = Eigen::Vector3f(0.02f, 0, 0);
  news.state.ledger.why[kLimits] = Reason::kJointSpeed;
  for (int i = 0; i < 1000 && report.out.force.cue.norm() < 0.1; ++i) tick();
  ASSERT_GT(report.out.force.cue.norm(), 0.1);
  tick(kForceStands);
  EXPECT_EQ(report.out.force.cue, Vec3(Vec3::Zero()));
  EXPECT_EQ(device.written.force, Vec3(Vec3::Zero()));
}

TEST_F(HapticLoopTest, ATickThatComesTwiceAtATimeStillMovesOn) {
  engage();
  loop->tick(now);
  loop->tick(now - kMillisecond);
  tick();
  EXPECT_EQ(report.out.link.state, SessionState::kEngaged);
  EXPECT_TRUE(is_finite(report.out.f_H_M));
}

TEST_F(HapticLoopTest, TwoStartsOfAMasterHaveNoEpochInCommon) {
  tick();
  const MasterState first = report.out.link;
  loop.emplace(device, LoopScene{settings}, boxes, now);
  tick();
  const MasterState second = report.out.link;
  constexpr std::uint64_t kLifetime = 1ULL << 40;  // stops of one start
  EXPECT_GT(second.stop_epoch - first.stop_epoch, kLifetime);
  EXPECT_GT(first.stop_epoch - second.stop_epoch, kLifetime);
  EXPECT_EQ(second.released_epoch, second.stop_epoch);
  EXPECT_NE(second.engagement_epoch, first.engagement_epoch);
}

TEST_F(HapticLoopTest, ARefusalAloneIsNoSlave) {
  slave_talks = false;
  tick();
  news.link.peer_epoch = 0;
  news.link.refused_at = now;
  news.link.refusal.leader = fixed_text<LeaderName>("process 4711");
  boxes.slave.publish(news);
  push(1, OrderKind::kEngage);
  tick();
  EXPECT_EQ(answer(1), Reason::kOtherMaster);
  now += 2 * kSecond;
  push(2, OrderKind::kEngage);
  tick();
  EXPECT_EQ(answer(2), Reason::kNoPeer);
}

TEST_F(HapticLoopTest, TellsHowLateItsTicksCame) {
  tick(kMillisecond + 100 * kMicrosecond);
  ticks(248);
  EXPECT_EQ(report.late_p50, 0);
  tick();
  EXPECT_NEAR(static_cast<double>(report.late_p50), 100e3, 7e3);
  EXPECT_EQ(report.late_max, 100 * kMicrosecond);
  EXPECT_EQ(report.overruns, 0u);
}

TEST_F(HapticLoopTest, ADeviceThatTurnsByItselfCallsTheTick) {
  ticks(10);
  // A turn each 1.02 ms, taken 50 us later: never late, though the loop's own clock would say so.
  for (int i = 0; i < 240; ++i) {
    now += 1020 * kMicrosecond;
    loop->tick(now + 50 * kMicrosecond, now);
  }
  ticks(1);
  EXPECT_EQ(report.overruns, 0u);
  EXPECT_LE(report.late_max, 60 * kMicrosecond);
  // When the device is silent, the loop's clock goes on from its last turn.
  EXPECT_EQ(loop->due(), now + kMillisecond);
}

TEST_F(HapticLoopTest, ATurnBeforeTheLoopsOwnClockBeginsIsATickLikeAnother) {
  const auto tap = std::make_unique<MasterTap>();
  loop.emplace(device, LoopScene{settings}, boxes, now + 50 * kMillisecond, tap.get());
  loop->tick(now, now);
  KeptTick kept;
  ASSERT_TRUE(tap->take(kept));
  EXPECT_EQ(kept.given.in.unseen, 0);
  EXPECT_GT(kept.given.dt, 0.0);
  EXPECT_EQ(loop->due(), now + kMillisecond);
}

TEST_F(HapticLoopTest, AForceThatMissedItsTurnCountsAsAnOverrun) {
  ticks(3);
  device.sample.force_missed = true;
  ticks(2);
  device.sample.force_missed = false;
  ticks(1);
  EXPECT_EQ(report.overruns, 2u);
}

TEST_F(HapticLoopTest, ADeviceIsAskedWhyItsReadingIsNotValidAndOnlyThen) {
  device.its_trouble = fixed_text<DeviceTrouble>("unplugged");
  ticks(2);
  EXPECT_EQ(text_of(report.trouble), "");
  device.sample.valid = false;
  ticks(1);
  EXPECT_EQ(text_of(report.trouble), "unplugged");
  device.sample.valid = true;
  ticks(1);
  EXPECT_EQ(text_of(report.trouble), "");
}

TEST_F(HapticLoopTest, TicksWithoutTouchingTheHeap) {
  pull_off_a_line();
  HapticSettings other = settings;
  other.scene = scene_name("second");
  boxes.scene.publish({other});
  OrderTicket wave;
  wave.is_hand = true;
  ASSERT_TRUE(boxes.orders.push(wave));
  push(3, OrderKind::kClutchOn);
  push(4, OrderKind::kClutchOff);
  push(5, OrderKind::kDisengage);
  push(6, OrderKind::kEngage);
  test::NoAllocation guard("a tick of the haptic loop");
  ticks(600);
  EXPECT_EQ(report.scene_epoch, 1u);
}

TEST_F(HapticLoopTest, AnAnswerIsNeverAheadOfItsReport) {
  ticks(2);
  push(1, OrderKind::kEngage);
  bool seen = false;
  device.its_hand.on_moving = [&] {
    // The other thread looks in just before the tick's report is out.
    OrderAnswer early;
    seen = boxes.answers.pop(early);
  };
  tick();
  EXPECT_FALSE(seen);
  EXPECT_EQ(answer(1), Reason::kNone);
}

}  // namespace
}  // namespace handrail
