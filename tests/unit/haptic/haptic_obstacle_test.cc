// What the master's step says, while off, of an engage that nobody has asked for yet.
#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "tests/unit/haptic/haptic_rig.h"

namespace handrail {
namespace {

using test::HapticRig;

TEST(HapticObstacle, WhileOffTheStepSaysWhatItRefusesAnEngageWithInTheNextTick) {
  const std::vector<std::function<void(HapticRig&)>> spoils = {
      [](HapticRig& r) { r.in.slave_known = false; },
      [](HapticRig& r) { r.in.slave_age = 100 * kMillisecond; },
      [](HapticRig& r) { r.in.slave_age = kSecond / 2; },
      [](HapticRig& r) { r.in.slave_age = 2 * kSecond; },
      [](HapticRig& r) { r.in.link.confirmed = false; },
      [](HapticRig& r) { r.in.link.other_master = true; },
      [](HapticRig& r) { r.in.slave.hashes.limits = 1; },
      [](HapticRig& r) { r.in.slave.hashes.tools = 1; },
      [](HapticRig& r) { r.in.slave.scene = scene_name("other"); },
      [](HapticRig& r) { r.in.slave.state = SessionState::kFault; },
      [](HapticRig& r) { r.in.slave.obstacle = Reason::kSensorMissing; },
      [](HapticRig& r) { r.in.hand.valid = false; },
      [](HapticRig& r) { r.settings.presence = Presence::kButton; },
      [](HapticRig& r) { r.settings.presence = Presence::kHold; },
  };
  for (std::size_t i = 0; i < spoils.size(); ++i) {
    HapticRig rig;
    rig.play_slave = false;
    spoils[i](rig);
    rig.ticks(30);
    const Reason said = rig.out.obstacle;
    EXPECT_NE(said, Reason::kNone) << i;
    EXPECT_EQ(rig.out.reason, Reason::kNotEngaged) << i;
    EXPECT_EQ(rig.order(OrderKind::kEngage), said) << i << ": " << describe(said);
  }
}

TEST(HapticObstacle, WhatTheOperatorMustDoWhileEngagingIsSaidLast) {
  HapticRig rig;
  rig.settings.presence = Presence::kHold;
  rig.in.slave_known = false;
  rig.ticks(30);
  EXPECT_EQ(rig.out.obstacle, Reason::kNoPeer);
  rig.in.slave_known = true;
  rig.tick();
  EXPECT_EQ(rig.out.obstacle, Reason::kPresence);
}

TEST(HapticObstacle, NothingStandsInTheWayOfAnEngageThatIsTakenNorOfOneThatIsOn) {
  HapticRig rig;
  rig.ticks(30);
  EXPECT_EQ(rig.out.obstacle, Reason::kNone);
  rig.engage();
  ASSERT_EQ(rig.session(), SessionState::kEngaged);
  rig.in.slave.scene = scene_name("other");
  rig.tick();
  EXPECT_EQ(rig.out.obstacle, Reason::kNone);
}

// The slave's fault is over once it is started anew; why the session ended is not.
TEST(HapticObstacle, WhyTheSlaveStoppedIsKnownUntilTheOperatorResets) {
  HapticRig rig;
  rig.engage();
  ASSERT_EQ(rig.session(), SessionState::kEngaged);
  EXPECT_EQ(rig.out.peer_fault, Reason::kNone);
  rig.in.slave.state = SessionState::kFault;
  rig.in.slave.fault = Reason::kFollowingError;
  rig.tick();
  ASSERT_EQ(rig.session(), SessionState::kFault);
  EXPECT_EQ(rig.out.reason, Reason::kPeerFault);
  EXPECT_EQ(rig.out.peer_fault, Reason::kFollowingError);
  rig.in.slave.state = SessionState::kOff;
  rig.in.slave.fault = Reason::kNone;
  rig.ticks(1000);
  EXPECT_EQ(rig.out.reason, Reason::kPeerFault);
  EXPECT_EQ(rig.out.peer_fault, Reason::kFollowingError);
  EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kPeerFault);
  EXPECT_EQ(rig.out.peer_fault, Reason::kFollowingError);
  EXPECT_EQ(rig.order(OrderKind::kReset), Reason::kNone);
  rig.tick();
  EXPECT_EQ(rig.session(), SessionState::kOff);
  EXPECT_EQ(rig.out.peer_fault, Reason::kNone);
}

// A master that is off does not go into fault with the slave: it says how the slave is.
TEST(HapticObstacle, WhileOffTheSlavesFaultIsTheOneItIsIn) {
  HapticRig rig;
  rig.ticks(30);
  rig.in.slave.state = SessionState::kFault;
  for (const Reason fault : {Reason::kRobotLost, Reason::kSensorStuck}) {
    rig.in.slave.fault = fault;
    rig.tick();
    EXPECT_EQ(rig.out.obstacle, Reason::kPeerFault);
    EXPECT_EQ(rig.out.peer_fault, fault);
  }
}

}  // namespace
}  // namespace handrail
