#include "client/experiment/way_to_a.h"

#include <gtest/gtest.h>

#include "server/base/random.h"
#include "server/base/units.h"

namespace handrail {
namespace {

const Pose kStart{Vec3(0.35, 0.0375, 0.329), Quat(0.0, 0.0, 1.0, 0.0)};

// A master that does what it is told, and an arm that takes its time.
struct Arm {
  StartSight sight;
  bool grips_at_a = true, let_go = false;

  void obey(const pb::Request& order) {
    if (order.has_clutch()) {
      sight.clutched = order.clutch();
      if (sight.clutched) sight.point.reset();  // ends the approach and drops its tool
    }
    if (order.tool().kind() == pb::Tool::POINT) {
      const auto& at = order.tool().at_mm();
      if (at.size() == 3) sight.point = kMm * Vec3(at[0], at[1], at[2]);
    }
    if (order.tool().kind() == pb::Tool::N_ROTATION) {
      const auto& turn = order.tool().turn_deg();
      ASSERT_EQ(turn.size(), 3);
      sight.kept = rotation_exp(kDeg * Vec3(turn[0], turn[1], turn[2])) * Quat(0.0, 0.0, 1.0, 0.0);
      sight.turning = true;
    }
    if (order.has_tool_off()) {
      sight.point.reset();
      sight.kept.reset();
      sight.turning = false;
    }
    sight.tool = sight.point || sight.kept;
    if (!order.has_grip()) return;
    sight.closed = order.grip();
    const bool at_a = (sight.X_ST.p - kStart.p).norm() <= kNearA;
    if (order.grip()) grips_at_a = grips_at_a && at_a;
    let_go = let_go || !order.grip();
  }
  void pass() {
    if (sight.clutched) return;
    if (sight.point) sight.X_ST.p += 0.3 * (*sight.point - sight.X_ST.p);
    if (!sight.kept) return;
    sight.X_ST.q = sight.X_ST.q.slerp(0.3, *sight.kept);
    sight.turning = angle_between(sight.X_ST.q, *sight.kept) > 0.1 * kDeg;
  }
};

TEST(WayToA, FromAnywhereTheArmComesAndWaitsWithoutTools) {
  Random random(20);
  for (int i = 0; i < 200; ++i) {
    Arm arm;
    arm.sight.drives = true;
    arm.sight.clutched = random.bits() % 2 == 0;
    arm.sight.tool = random.bits() % 2 == 0;
    arm.sight.gripper = random.bits() % 2 == 0;
    const bool carried = arm.sight.closed = arm.sight.gripper && random.bits() % 2 == 0;
    const Vec3 off(random.normal(), random.normal(), random.normal());
    const Vec3 turn(random.normal(), random.normal(), random.normal());
    arm.sight.X_ST.p = kStart.p + (i % 4 == 0 ? 0.0 : 0.05) * off;
    arm.sight.X_ST.q = (rotation_exp((i % 3 == 0 ? 0.0 : 0.3) * turn) * kStart.q).normalized();
    int orders = 0;
    for (int k = 0; k < 200; ++k) {
      if (const auto order = order_to_a(arm.sight, kStart)) {
        arm.obey(*order);
        ++orders;
      }
      arm.pass();
    }
    EXPECT_FALSE(order_to_a(arm.sight, kStart)) << i;
    EXPECT_TRUE(arm.sight.clutched && !arm.sight.tool) << i;
    EXPECT_LE((arm.sight.X_ST.p - kStart.p).norm(), kNearA) << i;
    EXPECT_LE(angle_between(arm.sight.X_ST.q, kStart.q), kNearUpright) << i;
    EXPECT_LE(orders, 8) << i;
    EXPECT_EQ(arm.sight.closed, arm.sight.gripper) << i;
    EXPECT_TRUE(arm.grips_at_a) << i;
    if (i % 4 != 0) {
      EXPECT_EQ(arm.let_go, carried) << "before it goes, not on the way; " << i;
    }
  }
}

TEST(WayToA, NobodyWhoDrivesNothingIsOrdered) {
  StartSight sight;
  sight.X_ST.p = kStart.p + Vec3(0.1, 0.0, 0.0);
  EXPECT_FALSE(order_to_a(sight, kStart));
}

}  // namespace
}  // namespace handrail
