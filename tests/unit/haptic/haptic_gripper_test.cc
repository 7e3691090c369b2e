// What the operator wants of the gripper lasts as long as the engagement.
#include <gtest/gtest.h>

#include "tests/unit/haptic/haptic_rig.h"

namespace handrail {
namespace {

using test::HapticRig;

Reason grip(HapticRig& rig, Grip wanted) {
  rig.in.order.grip = wanted;
  return rig.order(OrderKind::kGrip);
}

TEST(HapticGripper, NeedsAnEngagement) {
  HapticRig rig;
  EXPECT_EQ(grip(rig, Grip::kClosed), Reason::kNotEngaged);
  rig.tick();
  EXPECT_EQ(rig.out.link.grip, Grip::kAsItIs);
  rig.engage();
  EXPECT_EQ(rig.out.link.grip, Grip::kAsItIs);
  EXPECT_EQ(grip(rig, Grip::kClosed), Reason::kNone);
  rig.ticks(100);
  EXPECT_EQ(rig.out.link.grip, Grip::kClosed);
  EXPECT_EQ(grip(rig, Grip::kOpen), Reason::kNone);
  EXPECT_EQ(rig.out.link.grip, Grip::kOpen);
}

TEST(HapticGripper, MayBeOrderedWithTheClutchHeld) {
  HapticRig rig;
  rig.engage();
  EXPECT_EQ(rig.order(OrderKind::kClutchOn), Reason::kNone);
  rig.ticks(5);
  ASSERT_EQ(rig.session(), SessionState::kClutched);
  EXPECT_EQ(grip(rig, Grip::kClosed), Reason::kNone);
  EXPECT_EQ(rig.out.link.grip, Grip::kClosed);
}

// Otherwise it would close at the next engagement, on whatever is there then.
TEST(HapticGripper, IsForgottenWithTheEngagement) {
  for (const OrderKind end : {OrderKind::kDisengage, OrderKind::kStop}) {
    HapticRig rig;
    rig.engage();
    ASSERT_EQ(grip(rig, Grip::kClosed), Reason::kNone);
    rig.order(end);
    rig.ticks(20);
    EXPECT_EQ(rig.out.link.grip, Grip::kAsItIs);
    if (end == OrderKind::kStop) continue;
    rig.engage();
    ASSERT_EQ(rig.session(), SessionState::kEngaged);
    EXPECT_EQ(rig.out.link.grip, Grip::kAsItIs);
  }
}

}  // namespace
}  // namespace handrail
