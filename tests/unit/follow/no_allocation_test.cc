#include <gtest/gtest.h>

#include "tests/support/no_allocation.h"
#include "tests/unit/constraint/tool_samples.h"
#include "tests/unit/follow/follow_rig.h"
#include "tests/unit/haptic/haptic_rig.h"

namespace handrail {
namespace {

using test::Dice;
using test::NoAllocation;

TEST(NoAllocationInSteps, HapticStepDoesNotTouchTheHeapWhateverItIsOrdered) {
  test::HapticRig rig;
  rig.settings.has_torque = true;
  rig.settings.max_torque = 0.1;
  Dice dice(1);
  rig.engage();
  const NoAllocation guard("haptic_step");
  for (int i = 0; i < 3000; ++i) {
    rig.settings.guide.method = i < 1500 ? GuidanceMethod::kExact : GuidanceMethod::kPublished;
    rig.in.hand.X_MH.p += dice.within(1e-3);
    rig.in.hand.X_MH.q = (rotation_exp(dice.within(1e-2)) * rig.in.hand.X_MH.q).normalized();
    rig.in.hand.clutch_button = i % 97 > 90;
    rig.in.hand.valid = i % 113 != 0;
    if (i % 10 == 0) {
      rig.in.order.kind = static_cast<OrderKind>(i / 10 % 9);
      rig.in.order.tool = test::call_of(static_cast<ToolKind>(1 + i / 90 % 5));
      rig.in.order.tool.direction_S = Vec3::UnitX();
      rig.in.order.tool.normal_S = Vec3::UnitZ();
    } else if (i % 10 == 1) {
      rig.in.order.kind = OrderKind::kReset;
    } else if (i % 10 == 2) {
      rig.in.order.kind = OrderKind::kEngage;
    }
    rig.tick();
  }
}

TEST(NoAllocationInSteps, FollowStepDoesNotTouchTheHeapFreeLimitedOrBraking) {
  test::FollowRig rig;
  Dice dice(2);
  rig.engage();
  Pose target = rig.state.motion.X_ST;
  const NoAllocation guard("follow_step");
  for (int i = 0; i < 3000; ++i) {
    if (i % 40 == 0) {
      target.p += dice.within(0.2);
      target.q = (rotation_exp(dice.within(1.0)) * target.q).normalized();
    }
    if (i % 400 == 0) target = forward(rig.settings.motion->arm, test::home());
    rig.in.master.X_SU = target;
    rig.in.master_age = i % 100 > 95 ? 30 * kMillisecond : 0;
    rig.in.f_E_T.force = i % 60 > 50 ? Vec3(0, 0, 80) : Vec3(Vec3::Zero());
    rig.cycle();
  }
}

}  // namespace
}  // namespace handrail
