// Which reset releases what, and which engagement a slave is in.
#include <gtest/gtest.h>

#include "tests/unit/follow/follow_rig.h"

namespace handrail {
namespace {

using test::FollowRig;

TEST(FollowEpoch, AStopIsLatchedUntilAResetThatHasSeenIt) {
  FollowRig rig;
  rig.engage();
  rig.in.master.stop_epoch = 7;
  rig.in.master.released_epoch = 6;
  for (int i = 0; i < 30; ++i) rig.cycle();
  EXPECT_EQ(rig.out.link.state, SessionState::kFault);
  EXPECT_EQ(rig.out.link.reason, Reason::kStopRequested);
  EXPECT_EQ(rig.out.link.stop_epoch, 7u);
  rig.in.master.released_epoch = 7;
  rig.in.master.state = SessionState::kFault;
  rig.cycle();
  EXPECT_EQ(rig.out.link.state, SessionState::kFault);
  rig.in.master.fault_reset = rig.out.link.fault_epoch;
  rig.cycle();
  EXPECT_EQ(rig.out.link.state, SessionState::kOff);
}

// One that has stopped, reset and engaged many times before, or never.
TEST(FollowEpoch, TheHistoryOfAnotherMasterReleasesNoStop) {
  for (std::uint64_t history = 0; history < 5; ++history) {
    FollowRig rig;
    rig.state.fault_epoch = 0x5a5a5a5a5a5a5a5a;
    rig.engage();
    rig.in.master.stop_epoch = 1;
    for (int i = 0; i < 30; ++i) rig.cycle();
    ASSERT_EQ(rig.out.link.fault, Reason::kStopRequested);
    rig.in.master = MasterState();
    rig.in.master.stop_epoch = rig.in.master.released_epoch = history;
    rig.in.master.fault_reset = history;
    for (int i = 0; i < 30; ++i) rig.cycle();
    EXPECT_EQ(rig.out.link.state, SessionState::kFault) << history;
    rig.in.master.fault_reset = rig.out.link.fault_epoch;
    rig.cycle();
    EXPECT_EQ(rig.out.link.state, SessionState::kOff);
  }
}

TEST(FollowEpoch, AStopOnTopOfAResetOneIsNotReleasedByThatReset) {
  FollowRig rig;
  rig.engage();
  rig.in.master.stop_epoch = 7;
  rig.in.master.released_epoch = 6;
  rig.cycle();
  rig.in.master.fault_reset = rig.out.link.fault_epoch;
  rig.in.master.stop_epoch = 8;  // the cycle after the reset never came here
  rig.in.master.released_epoch = 7;
  rig.cycle();
  EXPECT_EQ(rig.out.link.stop_epoch, 8u);
  EXPECT_NE(rig.out.link.fault_epoch, rig.in.master.fault_reset);
  rig.in.master.released_epoch = 8;
  rig.cycle();
  EXPECT_EQ(rig.out.link.state, SessionState::kFault);
}

// The slave before this one had faults too, with numbers of its own.
TEST(FollowEpoch, AResetOfAnEarlierSlavesFaultDoesNotReleaseThisOnes) {
  for (const bool heard_before : {false, true}) {
    FollowRig rig;
    rig.state.fault_epoch = 0x5a5a5a5a5a5a5a5a;
    if (heard_before) rig.engage();
    rig.in.fault = Reason::kRobotBadPacket;
    rig.cycle();
    rig.in.fault = Reason::kNone;
    rig.in.master_known = true;
    rig.in.master_age = 0;
    for (std::uint64_t old = 0; old < 10; ++old) {
      rig.in.master.fault_reset = old;
      rig.cycle();
    }
    EXPECT_EQ(rig.out.link.state, SessionState::kFault);
    rig.in.master.fault_reset = rig.out.link.fault_epoch;
    rig.in.master.state = SessionState::kOff;
    rig.cycle();
    EXPECT_EQ(rig.out.link.state, SessionState::kOff);
  }
}

TEST(FollowEpoch, AResetOfAMasterThatHasNotAnsweredReleasesNothing) {
  FollowRig rig;
  rig.engage();
  rig.in.fault = Reason::kRobotBadPacket;
  rig.cycle();
  rig.in.fault = Reason::kNone;
  rig.in.master.fault_reset = rig.out.link.fault_epoch;
  rig.in.master.state = SessionState::kOff;
  rig.in.link.confirmed = false;
  for (int i = 0; i < 10; ++i) rig.cycle();
  EXPECT_EQ(rig.out.link.state, SessionState::kFault);
  rig.in.link.confirmed = true;
  rig.cycle();
  EXPECT_EQ(rig.out.link.state, SessionState::kOff);
}

TEST(FollowEpoch, ANewEngagementBeginsFromOffAndIsSaidByItsNumber) {
  FollowRig rig;
  rig.engage();
  const std::uint64_t first = rig.out.link.engagement_epoch;
  EXPECT_EQ(first, rig.in.master.engagement_epoch);
  ++rig.in.master.engagement_epoch;
  rig.in.master.state = SessionState::kAligning;
  rig.cycle();
  EXPECT_EQ(rig.out.link.state, SessionState::kOff);
  EXPECT_EQ(rig.out.link.engagement_epoch, first);
  for (int i = 0; i < 50 && rig.out.link.state != SessionState::kEngaged; ++i) {
    rig.follow(rig.state.motion.X_ST);
  }
  EXPECT_EQ(rig.out.link.state, SessionState::kEngaged);
  EXPECT_EQ(rig.out.link.engagement_epoch, first + 1);
}

TEST(FollowEpoch, WithoutTheSensorItNeedsASlaveNeitherAlignsNorEngages) {
  FollowRig rig;
  rig.settings.sensor_required = true;
  rig.in.wrench_valid = false;
  for (int i = 0; i < 5; ++i) rig.cycle();
  EXPECT_EQ(rig.out.link.obstacle, Reason::kSensorMissing);
  rig.in.master_known = true;
  rig.in.master_age = 0;
  rig.in.master.desired = Desired::kEngaged;
  rig.in.master.state = SessionState::kAligning;
  rig.in.master.has_command = true;
  for (int i = 0; i < 20; ++i) {
    rig.follow(rig.state.motion.X_ST);
    ASSERT_EQ(rig.out.link.state, SessionState::kOff);
    ASSERT_EQ(rig.out.link.reason, Reason::kSensorMissing);
  }
  rig.in.wrench_valid = true;
  rig.engage();
  EXPECT_EQ(rig.out.link.state, SessionState::kEngaged);
  EXPECT_EQ(rig.out.link.obstacle, Reason::kNone);
}

}  // namespace
}  // namespace handrail
