#include "server/constraint/position_tool.h"

#include <gtest/gtest.h>

#include "tests/unit/constraint/tool_samples.h"

namespace handrail {
namespace {

using test::Dice;
using test::ending_at;
using test::line_along;
using test::plane_across;
using test::point_at;

constexpr double kStep = 1e-4;

PositionTool exact(const ToolDefinition& tool) {
  return PositionTool(tool, GuidanceMethod::kExact, kStep);
}

// Nearest of many points spread over what `tool` allows, by distance alone: around `centre`, then
// ever closer around the best so far. Knows neither projection nor dot product.
Vec3 nearest_by_search(const ToolDefinition& tool, const Vec3& hand) {
  Vec3 u = tool.direction_S, v = Vec3::Zero();
  if (tool.kind == ToolKind::kPlane) {
    u = tool.normal_S.unitOrthogonal();
    v = tool.normal_S.cross(u);
  }
  double best_s = 0.0, best_t = 0.0;
  for (double grid = 0.1; grid > 1e-11; grid *= 0.2) {
    const double s0 = best_s, t0 = best_t;
    double best = 1e9;
    for (int i = -10; i <= 10; ++i) {
      for (int j = v.isZero() ? 0 : -10; j <= (v.isZero() ? 0 : 10); ++j) {
        const double s = s0 + i * grid, t = t0 + j * grid;
        if (tool.has_end && s > tool.end) continue;
        const double d = (tool.p_SA + s * u + t * v - hand).squaredNorm();
        if (d < best) best = d, best_s = s, best_t = t;
      }
    }
  }
  return tool.p_SA + best_s * u + best_t * v;
}

TEST(PositionTool, WithoutAToolTheProxyIsTheHand) {
  PositionTool tool;
  const Vec3 hand(1, 2, 3);
  EXPECT_FALSE(tool.active());
  EXPECT_EQ(tool.start(hand, Vec3::Zero()), hand);
  EXPECT_EQ(tool.advance(2.0 * hand), 2.0 * hand);
  EXPECT_EQ(tool.distance(hand), 0.0);
}

// Of a vector what is along the set is what the proxy of a hand that goes that way does.
TEST(PositionTool, WhatIsAlongTheSetIsHowTheProxyFollowsAHand) {
  Dice dice(4);
  for (int i = 0; i < 50; ++i) {
    const Vec3 anchor = dice.within(0.3), v = dice.within(0.05);
    ToolDefinition plane = plane_across(anchor, dice.unit());
    plane.direction_S = plane.normal_S.unitOrthogonal();
    for (const ToolDefinition& definition :
         {ToolDefinition(), point_at(anchor), line_along(anchor, dice.unit()), plane}) {
      PositionTool tool = exact(definition);
      const Vec3 hand = anchor + dice.within(0.05), start = tool.start(hand, hand);
      EXPECT_LT((tool.advance(hand + v) - start - tool.along(v)).norm(), 1e-15);
    }
  }
}

TEST(PositionTool, APointHoldsItsPlaceForEveryHand) {
  Dice dice(1);
  const Vec3 anchor(0.3, -0.1, 0.4);
  PositionTool tool = exact(point_at(anchor));
  EXPECT_EQ(tool.start(anchor + dice.within(0.05), anchor), anchor);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(tool.advance(dice.within(2.0)), anchor);
  EXPECT_DOUBLE_EQ(tool.distance(anchor + Vec3(0, 0.03, 0.04)), 0.05);
}

TEST(PositionTool, TheExactProxyOnALineIsTheNearestPointOfASearch) {
  Dice dice(2);
  for (int i = 0; i < 50; ++i) {
    const ToolDefinition line = line_along(dice.within(0.5), dice.unit());
    PositionTool tool = exact(line);
    tool.start(line.p_SA, line.p_SA);
    const Vec3 hand = line.p_SA + dice.within(0.4);
    const Vec3 best = nearest_by_search(line, hand);
    const Vec3 proxy = tool.advance(hand);
    // Along the line the distance is flat at its least: the search resolves about its square root.
    EXPECT_LT((proxy - best).norm(), 1e-7);
    EXPECT_LE((proxy - hand).norm(), (best - hand).norm() + 1e-15);
  }
}

TEST(PositionTool, TheExactProxyOnAPlaneIsTheNearestPointOfASearch) {
  Dice dice(3);
  for (int i = 0; i < 20; ++i) {
    const ToolDefinition plane = plane_across(dice.within(0.5), dice.unit());
    PositionTool tool = exact(plane);
    tool.start(plane.p_SA, plane.p_SA);
    const Vec3 hand = plane.p_SA + dice.within(0.4);
    const Vec3 best = nearest_by_search(plane, hand);
    const Vec3 proxy = tool.advance(hand);
    EXPECT_LT((proxy - best).norm(), 1e-7);
    EXPECT_LE((proxy - hand).norm(), (best - hand).norm() + 1e-15);
  }
}

TEST(PositionTool, TheProxyStopsAtTheEndPoint) {
  Dice dice(4);
  for (int i = 0; i < 50; ++i) {
    const ToolDefinition line = ending_at(line_along(dice.within(0.5), dice.unit()), 0.1);
    PositionTool tool = exact(line);
    tool.start(line.p_SA, line.p_SA);
    const Vec3 hand = line.p_SA + dice.within(0.4);
    EXPECT_LT((tool.advance(hand) - nearest_by_search(line, hand)).norm(), 1e-7);
    EXPECT_LE(tool.travel(tool.advance(dice.within(2.0))), 0.1 + 1e-15);
  }
}

TEST(PositionTool, AOneWayLineNeverGoesBackForRandomHands) {
  Dice dice(5);
  for (int run = 0; run < 20; ++run) {
    const ToolDefinition line = line_along(dice.within(0.3), dice.unit(), true);
    PositionTool tool = exact(line);
    double furthest = tool.travel(tool.start(line.p_SA + dice.within(0.02), line.p_SA));
    EXPECT_GE(furthest, -1e-15);
    for (int i = 0; i < 2000; ++i) {
      const Vec3 hand = line.p_SA + dice.within(0.3);
      const Vec3 proxy = tool.advance(hand);
      const double travel = tool.travel(proxy);
      EXPECT_GE(travel, furthest - 1e-15);
      EXPECT_LT(tool.distance(proxy), 1e-15);
      // Forward it does go, with the hand.
      EXPECT_NEAR(travel, std::max(furthest, tool.travel(hand)), 1e-12);
      furthest = std::max(furthest, travel);
    }
  }
}

TEST(PositionTool, AOneWayLineStartsNoEarlierThanWhatWasCommanded) {
  const ToolDefinition line = line_along(Vec3::Zero(), Vec3::UnitX(), true);
  PositionTool tool = exact(line);
  // The hand's proxy lags 20 mm behind the command, which must not be pulled back.
  EXPECT_EQ(tool.start({0.01, 0, 0}, {0.03, 0, 0}), Vec3(0.03, 0, 0));
  EXPECT_EQ(tool.start({0.05, 0, 0}, {0.03, 0, 0}), Vec3(0.05, 0, 0));
}

TEST(PositionTool, ALineBothWaysGoesBackWithTheHand) {
  PositionTool tool = exact(line_along(Vec3::Zero(), Vec3::UnitX()));
  tool.start(Vec3::Zero(), Vec3::Zero());
  EXPECT_EQ(tool.advance({0.1, 0.02, 0}), Vec3(0.1, 0, 0));
  EXPECT_EQ(tool.advance({-0.1, 0.02, 0}), Vec3(-0.1, 0, 0));
}

TEST(PositionTool, TheProxyStartsAtThePreviousProxyNotAtTheHand) {
  // The proxy so far stood at x = 40 mm; the hand has been pulled elsewhere.
  PositionTool tool = exact(line_along(Vec3::Zero(), Vec3::UnitX(), true));
  EXPECT_EQ(tool.start({0.04, 0.01, 0}, {0.04, 0.01, 0}), Vec3(0.04, 0, 0));
  EXPECT_EQ(tool.advance({0.01, 0.05, 0}), Vec3(0.04, 0, 0));
}

TEST(PositionTool, AOneWayPlaneGoesForwardOnlyAlongItsDirectionAndFreelyAcross) {
  Dice dice(6);
  ToolDefinition plane = plane_across(dice.within(0.3), dice.unit());
  plane.direction_S = plane.normal_S.unitOrthogonal();
  plane.one_way = true;
  plane = ending_at(plane, 0.2);
  const Vec3 across = plane.normal_S.cross(plane.direction_S);
  PositionTool tool = exact(plane);
  double furthest = tool.travel(tool.start(plane.p_SA, plane.p_SA));
  bool went_back_across = false;
  double last_across = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 hand = plane.p_SA + dice.within(0.3);
    const Vec3 proxy = tool.advance(hand);
    EXPECT_GE(tool.travel(proxy), furthest - 1e-15);
    EXPECT_LE(tool.travel(proxy), 0.2 + 1e-12);
    EXPECT_LT(tool.distance(proxy), 1e-15);
    EXPECT_NEAR((proxy - hand).dot(across), 0.0, 1e-15);
    furthest = std::max(furthest, tool.travel(proxy));
    went_back_across = went_back_across || proxy.dot(across) < last_across;
    last_across = proxy.dot(across);
  }
  EXPECT_TRUE(went_back_across);
  EXPECT_NEAR(furthest, 0.2, 1e-12);
}

TEST(PositionTool, APlaneWithAnyNormalHasTwoFreeDirections) {
  // Axes of the frame are where a perpendicular made by a cross product with a fixed axis fails.
  for (const Vec3& normal : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(-1, 0, 0),
                             Vec3(1, 1, 0), Vec3(1, 1e-12, 1e-12), Vec3(1, 1, 1)}) {
    PositionTool tool = exact(plane_across(Vec3::Zero(), normal));
    tool.start(Vec3::Zero(), Vec3::Zero());
    const Vec3 hand(0.05, -0.03, 0.08);
    const Vec3 n = normal.normalized();
    EXPECT_LT((tool.advance(hand) - (hand - hand.dot(n) * n)).norm(), 1e-15);
    EXPECT_NEAR(tool.distance(hand), std::abs(hand.dot(n)), 1e-15);
  }
}

TEST(PositionTool, TheProxyMovesNoFasterThanTheHand) {
  // What keeps the force continuous: wherever the hand is, a small motion gives a small motion.
  Dice dice(7);
  for (int run = 0; run < 50; ++run) {
    ToolDefinition tool_definition = run % 2 == 0 ? line_along(dice.within(0.3), dice.unit())
                                                  : plane_across(dice.within(0.3), dice.unit());
    tool_definition.one_way = run % 4 < 2;
    if (run % 2 != 0) {
      tool_definition.direction_S = tool_definition.normal_S.unitOrthogonal();
    }
    if (run % 3 == 0) tool_definition = ending_at(tool_definition, 0.05);
    PositionTool tool = exact(tool_definition);
    Vec3 hand = tool_definition.p_SA;
    Vec3 proxy = tool.start(hand, hand);
    for (int i = 0; i < 500; ++i) {
      const Vec3 move = dice.within(1e-2);
      hand += move;
      const Vec3 next = tool.advance(hand);
      EXPECT_LE((next - proxy).norm(), move.norm() + 1e-15);
      proxy = next;
    }
  }
}

}  // namespace
}  // namespace handrail
