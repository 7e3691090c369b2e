// Quality, loop age, confirmation, presence and homing in the master's step.
#include <gtest/gtest.h>

#include "tests/unit/haptic/haptic_rig.h"

namespace handrail {
namespace {

using test::HapticRig;

TEST(HapticLink, EngagesOnlyOverALinkThatWasGoodEnoughForASecond) {
  HapticRig rig;
  rig.settings.ladder.good_for = kSecond;
  rig.ticks(900);
  EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kLinkQuality);
  EXPECT_NEAR(rig.out.link_shares.heard, 0.9, 2e-3);
  EXPECT_EQ(rig.out.link_window, kSecond);
  rig.in.link.peer_received_of_100 = 74;
  rig.ticks(1100);
  EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kLinkQuality);
  EXPECT_NEAR(rig.out.link_shares.peer_lost, 0.26, 1e-9);
  rig.in.link.peer_received_of_100 = 75;
  rig.ticks(1100);
  // One bad moment does not begin the second anew, but nothing is engaged in it.
  rig.in.slave_age = 21 * kMillisecond;
  EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kLinkQuality);
  rig.in.slave_age = 0;
  EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kNone);
  rig.ticks(5);
  ASSERT_EQ(rig.session(), SessionState::kEngaged);
  // Driving goes on when it is fair, and holds while it is poor.
  rig.in.link.received_of_100 = 40;
  rig.ticks(5);
  EXPECT_EQ(rig.session(), SessionState::kEngaged);
  rig.in.link.received_of_100 = 39;
  rig.ticks(5);
  EXPECT_EQ(rig.session(), SessionState::kHold);
  EXPECT_TRUE(rig.out.reasons.has(Reason::kLinkQuality));
  rig.in.link.received_of_100 = 40;
  rig.ticks(5);
  EXPECT_EQ(rig.session(), SessionState::kEngaged);
}

TEST(HapticLink, TheSecondOfAGoodLinkIsOfTimeThatPassedNotOfTicks) {
  HapticRig rig;
  rig.settings.ladder.good_for = kSecond;
  rig.in.unseen = 15 * kMillisecond;
  rig.ticks(60);
  EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kLinkQuality);
  EXPECT_NEAR(rig.out.link_shares.heard, 0.915, 1e-9);
  rig.ticks(6);
  EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kNone);
  // What was not seen for over 20 ms counts as if nothing had come.
  rig.in.unseen = 50 * kMillisecond;
  rig.tick();
  EXPECT_NEAR(rig.out.link_shares.held, 0.05, 1e-9);
}

TEST(HapticLink, AnUnconfirmedSlaveIsNotEngaged) {
  HapticRig rig;
  rig.in.link.confirmed = false;
  EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kNotConfirmed);
  rig.ticks(5);
  EXPECT_EQ(rig.session(), SessionState::kOff);
}

TEST(HapticLink, HalfASecondOfConstantDelayTakesTheForceAndLeavesTheDrive) {
  HapticRig rig;
  rig.settings.ladder.fade_loop = 300 * kMillisecond;
  rig.spring_slack = false;
  rig.engage();
  rig.in.hand.X_MH.p.x() += 0.002;
  rig.ticks(300);
  ASSERT_GT(rig.out.f_H_M.force.norm(), 0.1);
  rig.in.link.loop_age = 500 * kMillisecond;
  const Pose before = rig.command();
  for (int i = 0; i < 1500; ++i) {
    rig.in.hand.X_MH.p.x() += 1e-5;
    rig.tick();
    ASSERT_EQ(rig.session(), SessionState::kEngaged);
  }
  EXPECT_EQ(rig.out.f_H_M.force.norm(), 0.0);
  EXPECT_TRUE(rig.out.reasons.has(Reason::kLoopAge));
  EXPECT_TRUE(rig.out.reasons.has(Reason::kForceFaded));
  EXPECT_GT((rig.command().p - before.p).norm(), 0.02);
  rig.in.link.loop_age = 50 * kMillisecond;
  rig.ticks(500);
  EXPECT_GT(rig.out.f_H_M.force.norm(), 0.1);
  EXPECT_FALSE(rig.out.reasons.has(Reason::kLoopAge));
}

TEST(HapticLink, TheForceIsGoneFiftyMillisecondsAfterTheLastDatagram) {
  HapticRig rig;
  rig.spring_slack = false;
  rig.engage();
  rig.in.hand.X_MH.p.x() += 0.02;
  rig.ticks(1000);
  ASSERT_GT(rig.out.f_H_M.force.norm(), 0.9 * rig.settings.force.continuous);
  for (int ms = 1; ms <= 50; ++ms) {
    rig.in.slave_age = ms * kMillisecond;
    rig.tick();
  }
  EXPECT_EQ(rig.out.f_H_M.force.norm(), 0.0);
}

TEST(HapticLink, WithoutPresenceTheCommandStandsAndForLongTheEngagementEnds) {
  for (const Presence kind : {Presence::kButton, Presence::kHold}) {
    HapticRig rig;
    rig.settings.presence = kind;
    const auto be_there = [&](bool there) {
      rig.in.hand.enable_button = there;
      rig.in.hold_heard = there ? 0 : kForever;
    };
    be_there(false);
    EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kPresence);
    be_there(true);
    rig.engage();
    ASSERT_EQ(rig.session(), SessionState::kEngaged);
    be_there(false);
    rig.tick();
    const Pose held = rig.command();
    for (int i = 0; i < 1000; ++i) {
      rig.in.hand.X_MH.p.y() += 1e-5;
      rig.tick();
      ASSERT_EQ(rig.command().p, held.p);
      ASSERT_EQ(rig.out.link.desired, Desired::kClutched);
      ASSERT_EQ(rig.out.reason, Reason::kPresence);
    }
    be_there(true);
    rig.tick();
    EXPECT_LT((rig.command().p - held.p).norm(), 1e-6);
    EXPECT_EQ(rig.session(), SessionState::kEngaged);
    be_there(false);
    rig.ticks(2001);
    EXPECT_EQ(rig.session(), SessionState::kOff);
    be_there(true);
    rig.ticks(10);
    EXPECT_EQ(rig.session(), SessionState::kOff);
    EXPECT_EQ(rig.out.reason, Reason::kPresence) << "what ended it, until somebody engages";
    rig.engage();
    EXPECT_EQ(rig.out.reason, Reason::kNone);
    rig.order(OrderKind::kDisengage);
    rig.ticks(10);
    EXPECT_EQ(rig.out.reason, Reason::kNotEngaged);
  }
}

TEST(HapticLink, WhatEndedAnEngagementIsSaidUntilAnOperatorHasDealtWithIt) {
  HapticRig rig;
  rig.engage();
  rig.in.order.why = Reason::kPresence;
  rig.order(OrderKind::kDisengage);
  rig.ticks(10);
  EXPECT_EQ(rig.out.reason, Reason::kPresence);
  rig.order(OrderKind::kStop);
  rig.ticks(10);
  EXPECT_EQ(rig.out.reason, Reason::kStopRequested);
  rig.order(OrderKind::kReset);
  rig.ticks(10);
  EXPECT_EQ(rig.out.reason, Reason::kNotEngaged);
}

TEST(HapticLink, ADeviceThatIsNotReadyIsWaitedForTenSeconds) {
  HapticRig rig;
  rig.in.device_ready = false;
  EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kNone);
  EXPECT_EQ(rig.session(), SessionState::kHoming);
  EXPECT_EQ(rig.out.reason, Reason::kHoming);
  rig.ticks(9000);
  EXPECT_EQ(rig.session(), SessionState::kHoming);
  HapticRig late = {};
  rig.ticks(1010);
  EXPECT_EQ(rig.session(), SessionState::kOff);
  rig.ticks(10);
  EXPECT_EQ(rig.session(), SessionState::kOff);

  late.in.device_ready = false;
  late.order(OrderKind::kEngage);
  late.ticks(100);
  late.in.device_ready = true;
  late.ticks(5);
  EXPECT_EQ(late.session(), SessionState::kEngaged);
}

}  // namespace
}  // namespace handrail
