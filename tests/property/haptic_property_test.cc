// The master's step under generated hands, orders, buttons, links and readings.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>

#include "server/link/check.h"
#include "tests/property/draws.h"
#include "tests/unit/haptic/haptic_rig.h"

namespace handrail {
namespace {

using test::below;
using test::between;
using test::within;

using test::HapticRig;

bool one_in(int n) { return below(n) == 0; }

HapticOrder any_order() {
  HapticOrder order;
  order.kind =
      *rc::gen::element(OrderKind::kEngage, OrderKind::kEngage, OrderKind::kDisengage,
                        OrderKind::kClutchOn, OrderKind::kClutchOff, OrderKind::kReset,
                        OrderKind::kTool, OrderKind::kTool, OrderKind::kTool, OrderKind::kToolOff);
  order.tool.kind = *rc::gen::element(ToolKind::kPoint, ToolKind::kLine, ToolKind::kPlane,
                                      ToolKind::kNRotation, ToolKind::kFRotation);
  order.tool.direction_S = within(1.0);
  order.tool.normal_S = within(1.0);
  order.tool.one_way = *rc::gen::arbitrary<bool>();
  order.tool.approach = one_in(4);
  order.drop_position = *rc::gen::arbitrary<bool>();
  order.drop_orientation = *rc::gen::arbitrary<bool>();
  return order;
}

void random_life(HapticRig& rig, int ticks) {
  rig.engage();
  for (int i = 0; i < ticks; ++i) {
    if (i % 8 == 0) {
      rig.in.hand.v_MH = within(0.4);
      rig.in.hand.clutch_button = one_in(8);
      rig.in.hand.drop_button = one_in(20);
      if (one_in(6)) rig.in.order = any_order();
      if (one_in(10) && rig.in.order.kind == OrderKind::kTool) {
        rig.in.order.tool.at_present = false;
        rig.in.order.tool.p_SA = rig.command().p + within(0.03);
      }
      rig.in.slave_age = one_in(20) ? from_seconds(between(0.0, 0.19)) : 0;
    }
    rig.in.hand.X_MH.p += 1e-3 * rig.in.hand.v_MH;
    rig.in.hand.X_MH.q = (rotation_exp(0.01 * rig.in.hand.v_MH) * rig.in.hand.X_MH.q).normalized();
    rig.tick();
  }
}

RC_GTEST_PROP(HapticProperty, ForceIsFiniteLimitedAccountedForAndSteppedGently, ()) {
  HapticRig rig;
  rig.spring_slack = *rc::gen::arbitrary<bool>();
  rig.settings.has_torque = *rc::gen::arbitrary<bool>();
  rig.settings.max_torque = 0.1;
  rig.engage();
  for (int i = 0; i < 40; ++i) {
    const HapticRig* watch = &rig;
    random_life(rig, 8);
    RC_ASSERT(watch->finite);
    RC_ASSERT(watch->most_force <= 3.3 + 1e-12);
    RC_ASSERT(watch->share_error < 1e-9);
    RC_ASSERT(watch->out.f_H_M.torque.norm() <= 0.1 + 1e-12);
  }
}

// Whatever comes before: freezing, engaging and clutching never move the command by themselves.
RC_GTEST_PROP(HapticProperty, AStillHandNeverMovesTheCommandAtAClutch, ()) {
  HapticRig rig;
  random_life(rig, 10 + below(290));
  rig.in.slave_age = 0;
  rig.in.hand.drop_button = false;
  rig.in.hand.clutch_button = true;
  rig.ticks(3);
  RC_PRE(rig.session() == SessionState::kClutched);
  const Pose frozen = rig.command();
  rig.in.hand.X_MH = {within(0.1), rotation_exp(within(1.7))};
  rig.tick();
  RC_ASSERT((rig.command().p - frozen.p).norm() == 0.0);
  // Tools still to be reached would pull on; without them nothing may move.
  rig.drop(true, true);
  rig.in.hand.clutch_button = false;
  rig.ticks(20);
  RC_PRE(rig.session() == SessionState::kEngaged);
  RC_ASSERT((rig.command().p - frozen.p).norm() < 1e-12);
  RC_ASSERT(angle_between(rig.command().q, frozen.q) < 1e-9);
}

RC_GTEST_PROP(HapticProperty, TheSlaveIsOnlyEverToldWhatIsAPoseAndATool, ()) {
  HapticRig rig;
  rig.engage();
  for (int i = 0; i < 30; ++i) {
    if (one_in(3)) {
      rig.in.hand.X_MH.p[below(3)] = *rc::gen::element(
          std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e308);
    } else {
      rig.in.hand.X_MH.p = within(0.1);
    }
    rig.in.order = any_order();
    rig.tick();
    RC_ASSERT(is_finite(rig.command()));
    RC_ASSERT(is_unit(rig.command().q));
    for (const ToolDefinition* tool :
         {&rig.out.link.position_tool, &rig.out.link.orientation_tool}) {
      RC_ASSERT(is_finite(tool->p_SA) && is_finite(tool->direction_S) && is_finite(tool->normal_S));
      RC_ASSERT(is_unit(tool->q_ref));
    }
  }
}

double extreme() {
  const double size =
      *rc::gen::element(0.0, 1e-12, 1e-6, 0.3, 5.77, 5.78, 9.9999999, 10.0, 1e6, 1e300);
  return one_in(2) ? size : -size;
}

Vec3 extremes() { return one_in(2) ? Vec3(extreme(), extreme(), extreme()) : within(0.3); }

HapticOrder extreme_order() {
  HapticOrder order = any_order();
  ToolCall& call = order.tool;
  call.at_present = one_in(2);
  call.p_SA = extremes();
  call.direction_S = extremes();
  call.normal_S = extremes();
  call.axis_S = extremes();
  call.has_axis = one_in(2);
  call.has_end = one_in(2);
  call.p_SE = extremes();
  call.stiffness = std::abs(extreme());
  return order;
}

// The slave refuses what is not sound, and both sides would fault: here every order is refused that
// leads there, and no way of the hand does.
RC_GTEST_PROP(HapticProperty, WhateverIsOrderedADatagramCarriesWhatIsSent, ()) {
  HapticRig rig;
  rig.engage();
  for (int i = 0; i < 60; ++i) {
    rig.in.order = extreme_order();
    rig.tick();
    RC_ASSERT(check(rig.out.link) == Reject::kNone);
    rig.ticks(3);
    RC_ASSERT(check(rig.out.link) == Reject::kNone);
  }
}

// Strokes of the clutch add up to 30 m at the robot.
TEST(HapticProperty, HoweverFarTheHandLeadsADatagramCarriesIt) {
  for (const Vec3& way : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0.6, 0, 0.8), Vec3(1, 1, 1)}) {
    HapticRig rig;
    rig.settings.guide.smoother_length = 5;  // all of a stroke gets through
    rig.engage();
    bool said = false;
    for (int stroke = 0; stroke < 80; ++stroke) {
      for (int i = 0; i < 20; ++i) {
        rig.in.hand.X_MH.p += 0.01 * way.normalized();
        rig.tick();
        ASSERT_EQ(check(rig.out.link), Reject::kNone) << stroke;
        said = said || rig.out.reasons.has(Reason::kOutOfReach);
      }
      rig.in.hand.clutch_button = true;
      rig.tick();
      rig.in.hand.X_MH.p.setZero();
      rig.tick();
      rig.in.hand.clutch_button = false;
    }
    EXPECT_GT(rig.command().p.norm(), 9.9);
    EXPECT_TRUE(said);
  }
}

// The hand at rest in the middle of its device, and the command at the end of all places.
void lead_out(HapticRig& rig, const Vec3& way) {
  for (int stroke = 0; stroke < 100 && !rig.out.reasons.has(Reason::kOutOfReach); ++stroke) {
    for (int i = 0; i < 20; ++i) {
      rig.in.hand.X_MH.p += 0.005 * way;
      rig.tick();
    }
    rig.in.hand.clutch_button = true;
    rig.tick();
    rig.in.hand.X_MH.p.setZero();
    rig.tick();
    rig.in.hand.clutch_button = false;
    rig.tick();
  }
}

RC_GTEST_PROP(HapticProperty, AToolCalledAtTheEndOfAllPlacesIsCarriedByADatagramToo, ()) {
  HapticRig rig;
  rig.settings.mapping.scale = between(2.0, 50.0);
  rig.settings.guide.smoother_length = 5;  // all of a stroke gets through
  rig.engage();
  const Vec3 way = within(1.0);
  RC_PRE(way.norm() > 0.1);
  lead_out(rig, way.normalized());
  RC_ASSERT(rig.command().p.norm() > 9.9);
  for (int i = 0; i < 40; ++i) {
    rig.in.order = one_in(3) ? extreme_order() : any_order();
    if (one_in(2)) rig.in.order.tool.at_present = true;
    rig.in.hand.X_MH.p = within(0.1);
    rig.in.hand.clutch_button = one_in(4);
    rig.tick();
    RC_ASSERT(check(rig.out.link) == Reject::kNone);
    rig.in.hand.X_MH.p += within(0.1);
    rig.ticks(3);
    RC_ASSERT(check(rig.out.link) == Reject::kNone);
    if (rig.session() == SessionState::kOff) rig.engage();
  }
}

// Whatever the guide is told to anchor a tool at.
TEST(HapticProperty, NoToolIsAnchoredWhereNoPlaceIs) {
  for (const ToolKind kind : {ToolKind::kPoint, ToolKind::kLine, ToolKind::kPlane}) {
    ToolCall call = test::call_of(kind);
    call.direction_S = call.normal_S = Vec3::UnitX();
    if (kind == ToolKind::kPlane) call.direction_S = Vec3::UnitY();
    ToolDefinition tool;
    for (const double far : {kFarthest, 1e300, std::numeric_limits<double>::quiet_NaN()}) {
      EXPECT_EQ(anchor(call, GuideSettings(), {far * Vec3::UnitZ(), Quat::Identity()}, tool),
                Reason::kToolValueInvalid);
    }
    EXPECT_EQ(
        anchor(call, GuideSettings(), {0.99 * kFarthest * Vec3::UnitZ(), Quat::Identity()}, tool),
        Reason::kNone);
  }
}

}  // namespace
}  // namespace handrail
