// Orientation tools with a reference: who turns the arm, how fast, and what stops it.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "server/base/units.h"
#include "server/follow/tool_tube.h"
#include "tests/unit/constraint/tool_samples.h"
#include "tests/unit/haptic/haptic_rig.h"

namespace handrail {
namespace {

using test::call_of;
using test::Dice;
using test::HapticRig;

constexpr double kHalf = std::numbers::pi;
// Straight at, across, a hair from and exactly half a turn off.
constexpr double kOffs[] = {0.0, 90.0 * kDeg, 179.999999 * kDeg, kHalf};

// Brings the tip to `angle` from where it stands, turned about an axis across its own.
ToolCall reference(const HapticRig& rig, ToolKind kind, double angle, const Vec3& across_T) {
  ToolCall call = call_of(kind);
  const Quat q_ref = rig.command().q * rotation_exp(angle * across_T);
  call.has_q_ref = kind == ToolKind::kNRotation;
  call.q_ref = q_ref;
  call.has_axis = call.has_axis_T = kind == ToolKind::kFRotation;
  call.axis_T = Vec3(0, 0, 2);  // need not be unit
  call.axis_S = 3.0 * (q_ref * Vec3::UnitZ());
  return call;
}
double off(const HapticRig& rig) {
  return rig.state->command.guide.orientation().deviation(rig.command().q);
}
Vec3 across_z(Dice& dice) { return dice.unit().cross(Vec3::UnitZ()).normalized(); }

// Ticks until the reference is reached, and says what went wrong on the way.
void come_to(HapticRig& rig, double angle) {
  const double most = rig.settings.guide.catch_up_rotation * HapticRig::kTick;
  const Vec3 place = rig.command().p;
  // At the full rate but for the blend's end, which takes some tenths of a second.
  const int limit = static_cast<int>((angle / rig.settings.guide.catch_up_rotation + 2.0) * 1e3);
  Quat last = rig.command().q;
  double left = angle;
  for (int i = 0; i < limit; ++i) {
    rig.tick();
    ASSERT_LE(angle_between(last, rig.command().q), most + 1e-7) << "tick " << i;
    ASSERT_LE(off(rig), left + 1e-7) << "tick " << i;
    last = rig.command().q;
    left = off(rig);
  }
  EXPECT_LT(left, 1e-7);
  EXPECT_FALSE(rig.out.turning);
  EXPECT_LT((rig.command().p - place).norm(), 1e-12);
  EXPECT_TRUE(rig.finite);
}

TEST(HapticReference, AFarOneIsComeToInBoundedStepsFromTheCallOn) {
  for (const ToolKind kind : {ToolKind::kNRotation, ToolKind::kFRotation}) {
    for (const double angle : kOffs) {
      SCOPED_TRACE(testing::Message() << name_of(kind) << ' ' << angle / kDeg);
      HapticRig rig;
      rig.settings.has_torque = true;
      rig.settings.max_torque = 0.05;
      rig.engage();
      const Quat before = rig.command().q;
      ASSERT_EQ(rig.call(reference(rig, kind, angle, Vec3::UnitX())), Reason::kNone);
      EXPECT_NEAR(rig.out.tool_angle, angle, 1e-7);
      EXPECT_EQ(rig.out.turning, angle > 0.0);
      EXPECT_LE(angle_between(before, rig.command().q),
                rig.settings.guide.catch_up_rotation * HapticRig::kTick + 1e-7);
      EXPECT_LT(rig.out.f_H_M.torque.norm(), 1e-9) << "nothing turns the hand there";
      come_to(rig, angle);
      EXPECT_NEAR(angle_between(before, rig.command().q), angle, 1e-6);
      EXPECT_LT(rig.out.f_H_M.torque.norm(), 1e-9);
    }
  }
}

TEST(HapticReference, DrawnOnesAreComeToWhateverTheHandDoesMeanwhile) {
  for (int run = 0; run < 40; ++run) {
    SCOPED_TRACE(run);
    Dice dice(static_cast<std::uint64_t>(4100 + run));
    HapticRig rig;
    rig.engage();
    const ToolKind kind = run % 2 == 0 ? ToolKind::kNRotation : ToolKind::kFRotation;
    const double angle = dice.between(0.0, kHalf);
    ASSERT_EQ(rig.call(reference(rig, kind, angle, across_z(dice))), Reason::kNone);
    double left = angle;
    // A hand that turns at up to 0.5 rad/s: F-rotation passes what is about its axis.
    const Vec3 rate = 0.5 * dice.unit();
    const double most = (rig.settings.guide.catch_up_rotation + 0.6) * HapticRig::kTick + 1e-7;
    Quat last = rig.command().q;
    for (int i = 0; i < 15000; ++i) {
      if (i < 1000) {
        rig.in.hand.X_MH.q =
            (rotation_exp(rate * HapticRig::kTick) * rig.in.hand.X_MH.q).normalized();
      }
      rig.tick();
      ASSERT_LE(angle_between(last, rig.command().q), most) << "tick " << i;
      last = rig.command().q;
    }
    left = off(rig);
    EXPECT_LT(left, 1e-7);
    EXPECT_TRUE(rig.finite);
  }
}

TEST(HapticReference, ToolsOffLeavesTheArmWhereItHasComeTo) {
  for (const ToolKind kind : {ToolKind::kNRotation, ToolKind::kFRotation}) {
    for (const int ticks : {1, 2000, 9000}) {
      HapticRig rig;
      rig.engage();
      ASSERT_EQ(rig.call(reference(rig, kind, 90.0 * kDeg, Vec3::UnitY())), Reason::kNone);
      rig.ticks(ticks);
      const Quat there = rig.command().q;
      ASSERT_EQ(rig.drop(false, true), Reason::kNone);
      EXPECT_FALSE(rig.out.turning);
      rig.ticks(3000);
      EXPECT_LT(angle_between(there, rig.command().q), 1e-7) << ticks;
      // And the hand leads on from where it is.
      rig.in.hand.X_MH.q = (rotation_exp({0, 0.1, 0}) * rig.in.hand.X_MH.q).normalized();
      rig.ticks(500);
      EXPECT_NEAR(angle_between(there, rig.command().q), 0.1, 1e-7);
    }
  }
}

TEST(HapticReference, AToolCalledOnTheWayKeepsWhatItFindsThere) {
  HapticRig rig;
  rig.engage();
  ASSERT_EQ(rig.call(reference(rig, ToolKind::kNRotation, 2.0, Vec3::UnitX())), Reason::kNone);
  rig.ticks(1500);
  const Quat there = rig.command().q;
  ASSERT_EQ(rig.call(call_of(ToolKind::kNRotation)), Reason::kNone);
  rig.ticks(3000);
  EXPECT_LT(angle_between(there, rig.command().q), 1e-7);
  rig.drop(false, true);
  rig.ticks(3000);
  EXPECT_LT(angle_between(there, rig.command().q), 1e-7);
}

TEST(HapticReference, TheClutchEndsTheWayAndTheArmDoesNotGoOnByItself) {
  HapticRig rig;
  rig.engage();
  ASSERT_EQ(rig.call(reference(rig, ToolKind::kFRotation, 1.5, Vec3::UnitX())), Reason::kNone);
  rig.ticks(1000);
  rig.order(OrderKind::kClutchOn);
  const Quat there = rig.command().q;
  EXPECT_EQ(rig.out.link.orientation_tool.kind, ToolKind::kNone);
  rig.ticks(500);
  rig.order(OrderKind::kClutchOff);
  rig.ticks(3000);
  EXPECT_LT(angle_between(there, rig.command().q), 1e-9);
}

TEST(HapticReference, OneThatIsReachedStaysThroughTheClutch) {
  HapticRig rig;
  rig.engage();
  ASSERT_EQ(rig.call(reference(rig, ToolKind::kNRotation, 0.4, Vec3::UnitX())), Reason::kNone);
  rig.ticks(4000);
  rig.order(OrderKind::kClutchOn);
  rig.ticks(100);
  rig.order(OrderKind::kClutchOff);
  rig.ticks(100);
  EXPECT_EQ(rig.out.link.orientation_tool.kind, ToolKind::kNRotation);
  EXPECT_LT(off(rig), 1e-9);
}

TEST(HapticReference, CalledWithTheClutchHeldTheArmTurnsOnceTheHandDrives) {
  for (const double angle : kOffs) {
    SCOPED_TRACE(angle / kDeg);
    HapticRig rig;
    rig.engage();
    rig.order(OrderKind::kClutchOn);
    rig.ticks(10);
    const Quat before = rig.command().q;
    ASSERT_EQ(rig.call(reference(rig, ToolKind::kNRotation, angle, Vec3::UnitX())), Reason::kNone);
    rig.ticks(500);
    EXPECT_EQ(angle_between(before, rig.command().q), 0.0);
    rig.order(OrderKind::kClutchOff);
    come_to(rig, angle);
    rig.drop(false, true);
    rig.ticks(1000);
    EXPECT_NEAR(angle_between(before, rig.command().q), angle, 1e-6);
  }
}

// The slave lets the commands of the way through, also where the way round is any.
TEST(HapticReference, TheSlavesTubeLetsTheWayThrough) {
  for (const ToolKind kind : {ToolKind::kNRotation, ToolKind::kFRotation}) {
    for (const double angle : kOffs) {
      SCOPED_TRACE(testing::Message() << name_of(kind) << ' ' << angle / kDeg);
      HapticRig rig;
      rig.engage();
      ToolTube tube;
      Pose tip = rig.command();
      tip.q = (tip.q * rotation_exp({1e-4, -2e-4, 1e-4})).normalized();  // a little behind
      MasterState none;
      tube.restart(none, tip);
      ASSERT_EQ(rig.call(reference(rig, kind, angle, Vec3::UnitX())), Reason::kNone);
      for (int i = 0; i < 14000; ++i) {
        ASSERT_EQ(tube.take(rig.out.link, tip), Reason::kNone);
        const Pose given = tube.project(rig.command(), tip);
        ASSERT_LT(angle_between(given.q, rig.command().q), 3e-4) << "tick " << i;
        tip = given;
        tube.close(rig.settings.guide.catch_up, rig.settings.guide.catch_up_rotation,
                   rig.command().p, tip.p, HapticRig::kTick);
        rig.tick();
      }
      EXPECT_LT(off(rig), 1e-7);
    }
  }
}

}  // namespace
}  // namespace handrail
