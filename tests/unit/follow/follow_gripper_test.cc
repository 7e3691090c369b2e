// When the slave passes on what is wanted of the gripper.
#include <gtest/gtest.h>

#include "tests/unit/follow/follow_rig.h"

namespace handrail {
namespace {

using test::FollowRig;

TEST(FollowGripper, MovesOnlyWhileTheArmMay) {
  FollowRig rig;
  rig.in.master.grip = Grip::kClosed;
  rig.in.master_known = true;
  rig.cycle();
  EXPECT_EQ(rig.out.grip, Grip::kAsItIs) << "not engaged";
  rig.engage();
  EXPECT_EQ(rig.out.grip, Grip::kClosed);
  rig.in.master.grip = Grip::kOpen;
  rig.cycle();
  EXPECT_EQ(rig.out.grip, Grip::kOpen);
  rig.in.master.desired = Desired::kOff;
  for (int i = 0; i < 3; ++i) rig.cycle();
  ASSERT_FALSE(follows(rig.out.link.state));
  EXPECT_EQ(rig.out.grip, Grip::kAsItIs) << "the controller keeps its outputs";
}

TEST(FollowGripper, AGapInTheLinkChangesNothing) {
  FollowRig rig;
  rig.engage();
  rig.in.master.grip = Grip::kClosed;
  rig.cycle();
  rig.in.master_age = 50 * kMillisecond;
  rig.in.master.grip = Grip::kOpen;  // what is no news any more
  for (int i = 0; i < 5; ++i) rig.cycle();
  ASSERT_EQ(rig.out.link.state, SessionState::kHold);
  EXPECT_EQ(rig.out.grip, Grip::kClosed);
}

TEST(FollowGripper, AStopLetsGoOfNothing) {
  FollowRig rig;
  rig.engage();
  rig.in.master.grip = Grip::kClosed;
  rig.cycle();
  rig.in.master.stop_epoch = 1;
  rig.in.master.grip = Grip::kOpen;
  rig.cycle();
  ASSERT_EQ(rig.out.link.state, SessionState::kFault);
  EXPECT_EQ(rig.out.grip, Grip::kAsItIs);
}

TEST(FollowGripper, TheMasterHearsWhatTheControllerSays) {
  FollowRig rig;
  EXPECT_EQ(rig.out.link.gripper, GripperState::kNone);
  rig.in.gripper = GripperState::kBetween;
  rig.cycle();
  EXPECT_EQ(rig.out.link.gripper, GripperState::kBetween);
}

}  // namespace
}  // namespace handrail
