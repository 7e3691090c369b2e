// Tools under generated hands, calls and settings.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <memory>

#include "server/haptic/guide.h"
#include "tests/property/draws.h"

namespace handrail {
namespace {

using test::below;
using test::between;
using test::within;

Vec3 any_unit() {
  const Vec3 v = within(1.0);
  return v.norm() > 1e-3 ? v.normalized() : Vec3::UnitX();
}

GuideSettings any_settings() {
  GuideSettings settings;
  settings.method = *rc::gen::element(GuidanceMethod::kExact, GuidanceMethod::kPublished);
  settings.smoother_length = *rc::gen::element(1, 2, 105, 200);
  settings.stiffness = between(50.0, 2000.0);
  settings.catch_up = between(0.01, 0.2);
  settings.reach = 1.0;
  return settings;
}

Pose any_pose() { return {within(0.5), rotation_exp(within(1.7))}; }

ToolCall any_position_call(const Vec3& near) {
  ToolCall call;
  call.kind = *rc::gen::element(ToolKind::kPoint, ToolKind::kLine, ToolKind::kPlane);
  call.at_present = *rc::gen::arbitrary<bool>();
  call.p_SA = near + within(0.05);
  call.direction_S = between(0.1, 10.0) * any_unit();
  call.normal_S = between(0.1, 10.0) * any_unit();
  call.one_way = *rc::gen::arbitrary<bool>();
  if (*rc::gen::arbitrary<bool>()) call.stiffness = between(50.0, 2000.0);
  return call;
}

RC_GTEST_PROP(GuideProperty, TheCommandComesNearerToTheToolAtABoundedSpeedAndThenStaysOnIt, ()) {
  constexpr double kDt = 1e-3;
  const GuideSettings settings = any_settings();
  const auto guide = std::make_unique<Guide>();
  Pose hand = any_pose();
  guide->restart(settings, hand);
  RC_PRE(guide->call(settings, any_position_call(hand.p), hand.p, hand) == Reason::kNone);
  double off = guide->position().distance(guide->command().p);
  const Vec3 drift = within(1e-4);
  for (int i = 0; i < 300; ++i) {
    hand.p += drift;
    if (i % 50 == 0) hand.p += within(0.02);
    const Guidance out = guide->step(settings, hand, kDt);
    const double now = guide->position().distance(out.X_SC.p);
    RC_ASSERT(now <= off + 1e-12);
    RC_ASSERT(now >= off - settings.catch_up * kDt - 2e-7);
    off = now;
  }
}

RC_GTEST_PROP(GuideProperty, AOneWayToolNeverTakesTheCommandBack, ()) {
  const GuideSettings settings = any_settings();
  const auto guide = std::make_unique<Guide>();
  Pose hand = any_pose();
  guide->restart(settings, hand);
  for (int i = 0; i < 20; ++i) {
    hand.p += within(2e-3);
    guide->step(settings, hand, 1e-3);
  }
  ToolCall call = any_position_call(hand.p);
  call.one_way = true;
  if (call.kind == ToolKind::kPoint) call.kind = ToolKind::kLine;
  RC_PRE(guide->call(settings, call, hand.p, hand) == Reason::kNone);
  const Vec3 forward = guide->position().definition().direction_S;
  double furthest = guide->command().p.dot(forward);
  for (int i = 0; i < 300; ++i) {
    hand.p += within(3e-3);
    if (i == 150) guide->restart(settings, guide->command()), hand = guide->command();
    const double travel = guide->step(settings, hand, 1e-3).X_SC.p.dot(forward);
    RC_ASSERT(travel > furthest - 1e-12);
    furthest = std::max(furthest, travel);
  }
}

RC_GTEST_PROP(GuideProperty, AnyChangeOfToolsLeavesCommandAndPullWhereTheyWere, ()) {
  GuideSettings settings = any_settings();
  settings.method = GuidanceMethod::kExact;  // the published one still has steps to go
  settings.smoother_length = 1;
  const auto guide = std::make_unique<Guide>();
  Pose hand = any_pose();
  guide->restart(settings, hand);
  for (int change = 0; change < 10; ++change) {
    for (int i = 0; i < 10; ++i) {
      hand.p += within(1e-3);
      guide->step(settings, hand, 1e-3);
    }
    // With the hand still, the tick of the change differs from the one before only by the easing.
    const Guidance before = guide->step(settings, hand, 1e-9);
    const double k_before = guide->stiffness(settings);
    const bool pulled = guide->position().active() || before.blending;
    if (below(3) == 0) {
      guide->drop_position(settings, hand);
    } else {
      guide->call(settings, any_position_call(hand.p), hand.p, hand);
    }
    const Guidance after = guide->step(settings, hand, 1e-9);
    RC_ASSERT((after.X_SC.p - before.X_SC.p).norm() < 3e-7);
    if (pulled) {
      RC_ASSERT((guide->stiffness(settings) * after.pull - k_before * before.pull).norm() <
                1e-6 * k_before);
    } else {
      RC_ASSERT(guide->stiffness(settings) * after.pull.norm() < 1e-3);
    }
  }
}

RC_GTEST_PROP(GuideProperty, AnyChangeOfOrientationToolsLeavesCommandAndTwistWhereTheyWere, ()) {
  GuideSettings settings = any_settings();
  settings.smoother_length = 1;
  const auto guide = std::make_unique<Guide>();
  Pose hand = any_pose();
  guide->restart(settings, hand);
  for (int change = 0; change < 10; ++change) {
    hand.q = (rotation_exp(within(0.5)) * hand.q).normalized();
    for (int i = 0; i < 10; ++i) guide->step(settings, hand, 1e-3);
    const Guidance before = guide->step(settings, hand, 1e-9);
    ToolCall call;
    call.kind = *rc::gen::element(ToolKind::kNRotation, ToolKind::kFRotation);
    call.has_axis = *rc::gen::arbitrary<bool>();
    call.axis_S = rotation_exp(within(0.3)) * (hand.q * Vec3::UnitZ());
    if (below(3) == 0) {
      guide->drop_orientation(settings, hand);
    } else {
      guide->call(settings, call, hand.p, hand);
    }
    const Guidance after = guide->step(settings, hand, 1e-9);
    RC_ASSERT(angle_between(after.X_SC.q, before.X_SC.q) < 1e-6);
    RC_ASSERT((after.twist_pull - before.twist_pull).norm() < 1e-6);
  }
}

RC_GTEST_PROP(GuideProperty, AnAnchoredToolHasUnitDirectionsWithinItself, ()) {
  const Pose tip = any_pose();
  ToolDefinition tool;
  RC_PRE(anchor(any_position_call(tip.p), GuideSettings(), tip, tool) == Reason::kNone);
  if (tool.kind != ToolKind::kPoint) RC_ASSERT(std::abs(tool.direction_S.norm() - 1.0) < 1e-12);
  if (tool.kind == ToolKind::kPlane) {
    RC_ASSERT(std::abs(tool.normal_S.norm() - 1.0) < 1e-12);
    RC_ASSERT(std::abs(tool.normal_S.dot(tool.direction_S)) < 1e-9);
  }
}

}  // namespace
}  // namespace handrail
