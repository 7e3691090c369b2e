// Tools called away from the tip: who moves the arm, how far and how fast, and what stops it.
#include <gtest/gtest.h>

#include <functional>
#include <utility>

#include "tests/unit/constraint/tool_samples.h"
#include "tests/unit/haptic/haptic_rig.h"

namespace handrail {
namespace {

using test::at;
using test::call_of;
using test::Dice;
using test::HapticRig;
using test::line_call;
using test::plane_call;

constexpr double kFar = 0.3102;  // below the tip [m]

ToolCall approach(ToolCall call) {
  call.approach = true;
  return call;
}
// A plane `depth` below the tip of the moment.
ToolCall floor_below(const HapticRig& rig, double depth) {
  return at(plane_call(Vec3::UnitZ()), rig.command().p + Vec3(0.7, -0.4, -depth));
}
double way(const HapticRig& rig, const Pose& from) { return (rig.command().p - from.p).norm(); }

TEST(HapticApproach, AToolFurtherThanTheReachIsRefusedWithItsDistanceAndMovesNothing) {
  HapticRig rig;
  rig.engage();
  const Pose tip = rig.command();
  ToolCall ends_behind = line_call(Vec3::UnitX());
  ends_behind = at(ends_behind, tip.p - Vec3(0.5, 0, 0));
  ends_behind.has_end = true;
  ends_behind.p_SE = tip.p - Vec3(0.2, 0, 0);
  const std::pair<ToolCall, double> calls[] = {
      {floor_below(rig, kFar), kFar},
      {at(call_of(ToolKind::kPoint), tip.p + Vec3(0.03, 0, 0.04)), 0.05},
      {at(line_call(Vec3::UnitY()), tip.p + Vec3(0.03, 0.9, 0.04)), 0.05},
      {ends_behind, 0.2},
      {floor_below(rig, 0.0201), 0.0201},
  };
  for (const auto& [call, distance] : calls) {
    EXPECT_EQ(rig.call(call), Reason::kToolFar);
    EXPECT_NEAR(rig.out.tool_distance, distance, 1e-12);
    EXPECT_EQ(rig.out.link.position_tool.kind, ToolKind::kNone);
    rig.ticks(50);
    EXPECT_LT(way(rig, tip), 1e-12);
  }
  EXPECT_EQ(rig.call(floor_below(rig, 0.0199)), Reason::kNone);
  EXPECT_NEAR(rig.out.tool_distance, 0.0199, 1e-12);
  rig.tick();
  EXPECT_EQ(rig.out.tool_distance, 0.0) << "of its own tick only";
}

TEST(HapticApproach, WhateverIsCalledAStillHandsArmGoesNoFurtherThanTheReach) {
  for (int run = 0; run < 60; ++run) {
    Dice dice(static_cast<std::uint64_t>(2100 + run));
    HapticRig rig;
    rig.engage();
    const Pose tip = rig.command();
    const ToolCall calls[] = {call_of(ToolKind::kPoint), line_call(dice.unit()),
                              line_call(dice.unit(), true), plane_call(dice.unit())};
    const Vec3 away = dice.between(0.0, run % 2 == 0 ? 0.03 : 0.6) * dice.unit();
    const Reason result = rig.call(at(calls[run % 4], tip.p + away));
    rig.ticks(2000);
    EXPECT_LE(way(rig, tip), result == Reason::kNone ? 0.020 + 1e-9 : 1e-12) << "run " << run;
  }
}

// A point lets the hand go far from the arm. What takes its place would let the arm go to the hand.
TEST(HapticApproach, WhateverTakesAToolsPlaceAStillHandsArmGoesNoFurtherThanTheReach) {
  for (int run = 0; run < 60; ++run) {
    Dice dice(static_cast<std::uint64_t>(2300 + run));
    HapticRig rig;
    rig.engage();
    ASSERT_EQ(rig.call(call_of(ToolKind::kPoint)), Reason::kNone);
    const Pose tip = rig.command();
    const Vec3 off = dice.between(0.0, run % 3 == 0 ? 0.012 : 0.08) * dice.unit();
    for (int i = 0; i < 500; ++i) {
      rig.in.hand.X_MH.p += off / 500.0;
      rig.tick();
    }
    ASSERT_LT(way(rig, tip), 1e-9);
    if (run % 4 == 0) rig.drop(true, true);
    if (run % 4 == 1) rig.call(line_call(dice.unit()));
    if (run % 4 == 2) rig.call(plane_call(dice.unit()));
    if (run % 4 == 3) rig.call(at(plane_call(dice.unit()), tip.p + 0.01 * dice.unit()));
    EXPECT_EQ(rig.out.order_result, Reason::kNone);
    const double off_S = 2.0 * off.norm();  // the mapping's scale
    if (run % 4 == 0) {
      EXPECT_NEAR(rig.out.hand_latched, off_S > 0.020 ? off_S : 0.0, 1e-9);
    }
    rig.ticks(3000);
    EXPECT_LE(way(rig, tip), 0.020 + 1e-9) << "run " << run;
    // And the hand leads on from where it is.
    rig.drop(true, true);
    rig.ticks(5000);
    const Pose before = rig.command();
    rig.in.hand.X_MH.p.y() += 0.01;  // up
    rig.ticks(500);
    EXPECT_NEAR(rig.command().p.z() - before.p.z(), 0.02, 1e-9);
  }
}

TEST(HapticApproach, OutOfReachAToolMustBeNearTheTipAndNearWhereTheTipIsSent) {
  HapticRig rig;
  rig.engage();
  const Vec3 tip = rig.command().p;
  rig.play_slave = false;  // the arm stays where it is
  rig.in.hand.X_MH.p.y() += 0.1;
  rig.ticks(500);
  const Vec3 sent = rig.command().p;
  ASSERT_NEAR((sent - tip).norm(), 0.2, 1e-9);
  for (const Vec3& p_SA : {sent, tip}) {
    EXPECT_EQ(rig.call(at(call_of(ToolKind::kPoint), p_SA)), Reason::kToolFar);
    EXPECT_NEAR(rig.out.tool_distance, 0.2, 1e-9);
  }
  EXPECT_EQ(rig.call(call_of(ToolKind::kPoint)), Reason::kNone) << "where it is sent anyway";
  rig.ticks(500);
  EXPECT_EQ(rig.command().p, sent);
}

TEST(HapticApproach, AnApproachGoesThereAtTheScenesPaceAndTakesTheHandAlong) {
  HapticRig rig;
  rig.settings.spring_stiffness = 0.0;  // only what a tool pulls
  rig.settings.guide.catch_up = 0.1;
  rig.engage();
  const Pose tip = rig.command();
  ASSERT_EQ(rig.call(approach(floor_below(rig, kFar))), Reason::kNone);
  EXPECT_NEAR(rig.out.tool_distance, kFar, 1e-12);
  rig.ticks(999);
  EXPECT_NEAR(way(rig, tip), 0.1, 1e-9);
  EXPECT_NEAR(rig.command().p.z(), tip.p.z() - 0.1, 1e-9) << "straight there";
  EXPECT_TRUE(rig.out.blending);
  rig.ticks(4000);
  EXPECT_NEAR(rig.command().p.z(), tip.p.z() - kFar, 1e-9);
  EXPECT_FALSE(rig.state->command.guide.approaching());
  EXPECT_LT(rig.most_force, 1e-9) << "nothing pulls the hand";
  // The hand is as after a clutch: without the tool nothing goes back.
  rig.drop(true, true);
  rig.ticks(500);
  EXPECT_NEAR(rig.command().p.z(), tip.p.z() - kFar, 1e-9);
  rig.in.hand.X_MH.p.y() += 0.01;  // up
  rig.ticks(500);
  EXPECT_NEAR(rig.command().p.z(), tip.p.z() - kFar + 0.02, 1e-9);
}

TEST(HapticApproach, TheClutchEndsItForGood) {
  for (const bool button : {false, true}) {
    HapticRig rig;
    rig.engage();
    ASSERT_EQ(rig.call(approach(floor_below(rig, kFar))), Reason::kNone);
    rig.ticks(1000);
    const Pose stopped = rig.command();
    if (button) rig.in.hand.clutch_button = true, rig.tick();
    if (!button) rig.order(OrderKind::kClutchOn);
    EXPECT_EQ(rig.out.link.position_tool.kind, ToolKind::kNone);
    rig.ticks(500);
    ASSERT_EQ(rig.session(), SessionState::kClutched);
    EXPECT_EQ(way(rig, stopped), 0.0);
    rig.in.hand.X_MH.p += Vec3(0.01, 0.02, 0.03);
    rig.in.hand.clutch_button = false;
    if (!button) rig.order(OrderKind::kClutchOff);
    rig.ticks(2000);
    ASSERT_EQ(rig.session(), SessionState::kEngaged);
    EXPECT_LT(way(rig, stopped), 1e-12);
  }
}

TEST(HapticApproach, AHandThatIsNotThereEndsItToo) {
  HapticRig rig;
  rig.engage();
  ASSERT_EQ(rig.call(approach(floor_below(rig, kFar))), Reason::kNone);
  rig.ticks(500);
  rig.in.hand.valid = false;
  rig.ticks(100);
  const Pose stopped = rig.command();
  rig.in.hand.valid = true;
  rig.ticks(1000);
  EXPECT_LT(way(rig, stopped), 1e-12);
  EXPECT_EQ(rig.out.link.position_tool.kind, ToolKind::kNone);
}

TEST(HapticApproach, ItWantsAHandThatDrives) {
  HapticRig rig;
  rig.in.hand.clutch_button = true;
  rig.engage();
  ASSERT_EQ(rig.session(), SessionState::kClutched);
  EXPECT_EQ(rig.call(approach(floor_below(rig, kFar))), Reason::kClutched);
  rig.in.hand.clutch_button = false;
  rig.ticks(3);
  rig.in.hand.valid = false;
  rig.ticks(30);
  EXPECT_EQ(rig.call(approach(floor_below(rig, kFar))), Reason::kDeviceInvalid);
  rig.order(OrderKind::kDisengage);
  EXPECT_EQ(rig.call(approach(floor_below(rig, kFar))), Reason::kNotEngaged);
}

TEST(HapticApproach, AnyOtherChangeOfPositionToolsEndsItWhereTheArmIs) {
  const std::function<void(HapticRig&)> changes[] = {
      [](HapticRig& rig) { rig.drop(true, false); },
      [](HapticRig& rig) { rig.in.hand.drop_button = true, rig.tick(); },
      [](HapticRig& rig) { EXPECT_EQ(rig.call(plane_call(Vec3::UnitX())), Reason::kNone); },
      [](HapticRig& rig) { EXPECT_EQ(rig.call(line_call(Vec3::UnitZ(), true)), Reason::kNone); },
      [](HapticRig& rig) { EXPECT_EQ(rig.call(line_call(-Vec3::UnitZ(), true)), Reason::kNone); },
      [](HapticRig& rig) { EXPECT_EQ(rig.call(call_of(ToolKind::kPoint)), Reason::kNone); },
  };
  for (const auto& change : changes) {
    HapticRig rig;
    rig.settings.spring_stiffness = 0.0;
    rig.engage();
    ASSERT_EQ(rig.call(approach(floor_below(rig, kFar))), Reason::kNone);
    rig.ticks(1000);
    const Pose there = rig.command();
    change(rig);
    EXPECT_FALSE(rig.state->command.guide.approaching());
    rig.ticks(3000);
    EXPECT_LT(way(rig, there), 1e-9) << &change - changes;
    EXPECT_LT(rig.most_force, 1e-9) << "and the hand is there";
  }
}

TEST(HapticApproach, ARefusedCallLeavesItAsItIs) {
  HapticRig rig;
  rig.engage();
  const Pose tip = rig.command();
  ASSERT_EQ(rig.call(approach(floor_below(rig, kFar))), Reason::kNone);
  rig.ticks(1000);
  EXPECT_EQ(rig.call(floor_below(rig, 0.5)), Reason::kToolFar);
  EXPECT_EQ(rig.call(call_of(ToolKind::kNRotation)), Reason::kNone);
  rig.ticks(9000);
  EXPECT_NEAR(rig.command().p.z(), tip.p.z() - kFar, 1e-9);
}

// The arm would have to run after whatever the command has gone meanwhile.
TEST(HapticApproach, NothingIsEasedWhileTheLinkHolds) {
  HapticRig rig;
  rig.engage();
  const Pose tip = rig.command();
  ASSERT_EQ(rig.call(approach(floor_below(rig, kFar))), Reason::kNone);
  rig.ticks(500);
  const Pose there = rig.command();
  rig.in.slave_age = 100 * kMillisecond;
  rig.ticks(100);
  ASSERT_EQ(rig.session(), SessionState::kHold);
  EXPECT_LT(way(rig, there), 1e-12);
  rig.in.slave_age = 0;
  rig.ticks(9000);
  EXPECT_NEAR(rig.command().p.z(), tip.p.z() - kFar, 1e-9);
}

TEST(HapticApproach, NoOrientationToolTurnsAStillHandsArm) {
  for (int run = 0; run < 20; ++run) {
    Dice dice(static_cast<std::uint64_t>(2200 + run));
    HapticRig rig;
    rig.engage();
    const Pose tip = rig.command();
    ToolCall call = call_of(run == 0 ? ToolKind::kNRotation : ToolKind::kFRotation);
    call.has_axis = true;  // at any angle to the tip's own
    call.axis_S = dice.unit();
    ASSERT_EQ(rig.call(call), Reason::kNone);
    rig.ticks(2000);
    EXPECT_LT(angle_between(rig.command().q, tip.q), 1e-7) << "run " << run;
    EXPECT_LT(way(rig, tip), 1e-12);
  }
}

}  // namespace
}  // namespace handrail
