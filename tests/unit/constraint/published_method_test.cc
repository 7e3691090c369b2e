#include <gtest/gtest.h>

#include "server/constraint/position_tool.h"
#include "tests/unit/constraint/tool_samples.h"

namespace handrail {
namespace {

using test::Dice;
using test::ending_at;
using test::line_along;
using test::plane_across;

constexpr double kPublishedStep = 1e-4;

PositionTool published(const ToolDefinition& tool) {
  return PositionTool(tool, GuidanceMethod::kPublished, kPublishedStep);
}

// What slow hands see: at most half a step along each free direction away from the exact proxy.
TEST(PublishedMethod, StaysWithinAStepOfTheExactProxy) {
  Dice dice(11);
  for (int run = 0; run < 20; ++run) {
    ToolDefinition definition = run % 2 == 0
                                    ? line_along(dice.within(0.3), dice.unit(), run % 4 == 0)
                                    : plane_across(dice.within(0.3), dice.unit());
    if (run % 3 == 0 && run % 2 == 0) definition = ending_at(definition, 0.01);
    PositionTool steps = published(definition);
    PositionTool closed(definition, GuidanceMethod::kExact, kPublishedStep);
    Vec3 hand = definition.p_SA;
    steps.start(hand, hand);
    closed.start(hand, hand);
    for (int i = 0; i < 2000; ++i) {
      hand += dice.within(1e-3);
      EXPECT_LT((steps.advance(hand) - closed.advance(hand)).norm(), kPublishedStep);
    }
  }
}

TEST(PublishedMethod, DoesBoundedWorkForAHandAMetreAwayAndCarriesOnNextTick) {
  PositionTool tool = published(line_along(Vec3::Zero(), Vec3::UnitX()));
  double last = tool.start(Vec3::Zero(), Vec3::Zero()).x();
  int ticks = 0;
  while (last < 1.0 - kPublishedStep) {
    const double now = tool.advance(Vec3::UnitX()).x();
    ASSERT_GT(now, last);
    // 10,000 steps in one tick would be the unbounded loop.
    ASSERT_LT(now - last, 0.1);
    last = now;
    ASSERT_LT(++ticks, 1000);
  }
  EXPECT_GT(ticks, 10);
  EXPECT_NEAR(last, 1.0, kPublishedStep);
}

TEST(PublishedMethod, ReachesADistantHandOnAPlaneAlongBothDirections) {
  PositionTool tool = published(plane_across(Vec3::Zero(), Vec3::UnitZ()));
  tool.start(Vec3::Zero(), Vec3::Zero());
  const Vec3 hand(0.2, -0.3, 0.1);
  Vec3 proxy;
  for (int i = 0; i < 200; ++i) proxy = tool.advance(hand);
  EXPECT_NEAR(proxy.x(), 0.2, kPublishedStep);
  EXPECT_NEAR(proxy.y(), -0.3, kPublishedStep);
  EXPECT_EQ(proxy.z(), 0.0);
}

TEST(PublishedMethod, AHandHalfwayBetweenTwoStepsDoesNotMakeTheProxyChatter) {
  PositionTool tool = published(line_along(Vec3::Zero(), Vec3::UnitX()));
  tool.start(Vec3::Zero(), Vec3::Zero());
  const Vec3 hand(0.5 * kPublishedStep, 0, 0);
  const Vec3 first = tool.advance(hand);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(tool.advance(hand), first);
}

TEST(PublishedMethod, OneWayNeverGoesBackAndNeverPassesItsEnd) {
  Dice dice(12);
  const ToolDefinition line = ending_at(line_along(Vec3::Zero(), Vec3::UnitX(), true), 0.0333);
  PositionTool tool = published(line);
  double furthest = tool.start(Vec3::Zero(), Vec3::Zero()).x();
  for (int i = 0; i < 5000; ++i) {
    const double now = tool.advance(dice.within(0.1)).x();
    EXPECT_GE(now, furthest);
    EXPECT_LE(now, line.end);
    furthest = now;
  }
  EXPECT_NEAR(furthest, line.end, kPublishedStep);
}

}  // namespace
}  // namespace handrail
