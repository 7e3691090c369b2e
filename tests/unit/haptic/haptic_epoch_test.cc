// Which engagement a master takes for its own, what a reset names, and whom it cannot engage.
#include <gtest/gtest.h>

#include "tests/unit/haptic/haptic_rig.h"

namespace handrail {
namespace {

using test::HapticRig;

// Disengaged and engaged again before the slave has heard of it.
TEST(HapticEpoch, ASlaveThatIsStillInTheLastEngagementDoesNotEngage) {
  HapticRig rig;
  rig.engage();
  rig.play_slave = false;
  rig.order(OrderKind::kDisengage);
  EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kNone);
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(rig.session(), SessionState::kAligning);
    rig.tick();
  }
  rig.in.slave.state = SessionState::kOff;
  rig.tick();
  EXPECT_EQ(rig.session(), SessionState::kAligning);
  rig.play_slave = true;
  rig.ticks(3);
  EXPECT_EQ(rig.session(), SessionState::kEngaged);
}

TEST(HapticEpoch, ASlaveThatCannotBeEngagedIsNotAndItsReasonStays) {
  HapticRig rig;
  rig.in.slave.obstacle = Reason::kSensorMissing;
  EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kSensorMissing);
  rig.ticks(3);
  EXPECT_EQ(rig.session(), SessionState::kOff);
  // It turns up while the two align.
  rig.in.slave.obstacle = Reason::kNone;
  rig.play_slave = false;
  EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kNone);
  rig.in.slave.obstacle = Reason::kSensorInvalid;
  rig.ticks(3);
  EXPECT_EQ(rig.session(), SessionState::kOff);
  EXPECT_EQ(rig.out.link.desired, Desired::kOff);
  EXPECT_EQ(rig.out.reason, Reason::kSensorInvalid);
}

// What the slave said last before it fell silent may be over: a reset names what is seen.
TEST(HapticEpoch, AResetNamesNoFaultOfASlaveThatIsNotHeard) {
  HapticRig rig;
  rig.ticks(2);
  rig.in.slave.state = SessionState::kFault;
  rig.in.slave.fault_epoch = 77;
  rig.tick();
  rig.in.slave_age = 201 * kMillisecond;
  EXPECT_EQ(rig.order(OrderKind::kReset), Reason::kNone);
  EXPECT_NE(rig.out.link.fault_reset, 77u);
  rig.in.slave_age = 200 * kMillisecond;
  EXPECT_EQ(rig.order(OrderKind::kReset), Reason::kNone);
  EXPECT_EQ(rig.out.link.fault_reset, 77u);
}

TEST(HapticEpoch, ASlaveLedByAnotherMasterIsNotEngaged) {
  HapticRig rig;
  rig.in.link.other_master = true;
  EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kOtherMaster);
  rig.in.slave_age = kForever;
  EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kOtherMaster);
  rig.in.hand.valid = false;
  rig.ticks(30);
  EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kOtherMaster);
}

// As long as another leads, neither a reset nor anything else gets this one further.
TEST(HapticEpoch, WhoLeadsIsSaidBeforeWhatIsLatchedHere) {
  HapticRig rig;
  rig.engage();
  rig.in.slave_age = kSecond / 2;
  rig.tick();
  ASSERT_EQ(rig.session(), SessionState::kFault);
  rig.in.link.other_master = true;
  EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kOtherMaster);
  rig.order(OrderKind::kStop);
  EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kOtherMaster);
  rig.in.link.other_master = false;
  rig.in.slave_age = 0;
  EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kStopRequested);
  EXPECT_EQ(rig.order(OrderKind::kReset), Reason::kNone);
  rig.in.slave.state = SessionState::kOff;
  rig.ticks(3);
  EXPECT_EQ(rig.order(OrderKind::kEngage), Reason::kNone);
}

}  // namespace
}  // namespace handrail
