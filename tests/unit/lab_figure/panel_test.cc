// Panels: known data at known places.
#include "server/lab/figure/panel.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <sstream>

#include "tests/unit/lab_figure/svg_shapes.h"

namespace handrail::figure {
namespace {

constexpr double kFailedRank = std::numeric_limits<double>::infinity();
constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
// y from 0 to 10 is from 150 to 50; x from 0 to 20 is from 100 to 300.
constexpr Rect kPanelFrame = {100, 50, 200, 100};
const Axis kX = {.label = "x", .low = 0.0, .high = 20.0};
const Axis kY = {.label = "y", .low = 0.0, .high = 10.0};
constexpr Style kRed = {.colour = "#ff0000"};

std::string drawn(const Panel& panel) {
  Svg svg;
  panel.draw(svg, kPanelFrame, 40, 20);
  return svg.shapes();
}

Axis categories(const std::vector<std::string>& names) {
  Axis axis;
  axis.categories = names;
  return axis;
}

// Corners of the polyline as written.
std::vector<Point> corners(const std::string& element) {
  std::istringstream in(attribute(element, "points"));
  std::vector<Point> out;
  char comma = 0;
  for (Point p; in >> p.x >> comma >> p.y;) out.push_back(p);
  return out;
}

// What is red in a panel of one box of these values, the only category: x 160 to 240.
std::string box_of(std::vector<double> values, const Axis& y = kY) {
  Panel panel("", categories({"A"}), y);
  panel.box({.values = std::move(values), .style = kRed, .width = 0.4});
  return drawn(panel);
}

// A red line from and to these places exists.
bool has_line(const std::string& svg, double x1, double y1, double x2, double y2) {
  for (const std::string& line : having(elements(svg, "line"), "stroke", "#ff0000")) {
    if (value(line, "x1") == x1 && value(line, "y1") == y1 && value(line, "x2") == x2 &&
        value(line, "y2") == y2) {
      return true;
    }
  }
  return false;
}

TEST(PanelBox, StandsWhereItsNumbersAre) {
  const std::string svg = box_of({1, 2, 5, 8, 9});  // quartiles 2, 5, 8; whiskers 1 and 9
  const auto rects = elements(svg, "rect");
  ASSERT_EQ(rects.size(), 1u);
  EXPECT_EQ(value(rects[0], "x"), 160);
  EXPECT_EQ(value(rects[0], "y"), 70);
  EXPECT_EQ(value(rects[0], "width"), 80);
  EXPECT_EQ(value(rects[0], "height"), 60);
  EXPECT_TRUE(has_line(svg, 160, 100, 240, 100)) << "median";
  EXPECT_TRUE(has_line(svg, 160, 130, 240, 130)) << "q1";
  EXPECT_TRUE(has_line(svg, 160, 70, 240, 70)) << "q3";
  EXPECT_TRUE(has_line(svg, 200, 130, 200, 140)) << "lower whisker";
  EXPECT_TRUE(has_line(svg, 180, 140, 220, 140)) << "its end";
  EXPECT_TRUE(has_line(svg, 200, 70, 200, 60)) << "upper whisker";
  EXPECT_TRUE(has_line(svg, 180, 60, 220, 60)) << "its end";
  EXPECT_TRUE(elements(svg, "circle").empty());
}

TEST(PanelBox, DrawsOutliersAsHollowCircles) {
  const std::string svg = box_of({3, 2, 4, 9.5, 2, 3, 4, 3, 3});
  const auto circles = elements(svg, "circle");
  ASSERT_EQ(circles.size(), 1u);
  EXPECT_EQ(value(circles[0], "cx"), 200);
  EXPECT_EQ(value(circles[0], "cy"), 55);
  EXPECT_EQ(attribute(circles[0], "fill"), "#ffffff");
}

TEST(PanelBox, IsOpenAtTheTopWhenFailuresDecideAQuartile) {
  const std::string svg = box_of({2, 4, 6, kFailedRank, kFailedRank});  // quartiles 4, 6, infinite
  const auto rects = elements(svg, "rect");
  ASSERT_EQ(rects.size(), 1u);
  EXPECT_EQ(value(rects[0], "y"), 50);
  EXPECT_EQ(value(rects[0], "height"), 60);
  EXPECT_TRUE(has_line(svg, 160, 50, 160, 110)) << "a side";
  EXPECT_FALSE(has_line(svg, 160, 50, 240, 50)) << "no upper edge";
  EXPECT_TRUE(has_line(svg, 160, 90, 240, 90)) << "median";
  EXPECT_NE(svg.find(">2 of 5 failed<"), std::string::npos);
}

TEST(PanelBox, SaysNothingOfFailuresWhenThereAreNone) {
  EXPECT_EQ(box_of({1, 2, 3}).find("failed"), std::string::npos);
}

TEST(PanelBox, MarksAPublishedValueWithItsLabel) {
  Panel panel("", categories({"A", "B"}), kY);
  panel.box({.at = 2,
             .values = {1, 2, 3},
             .style = kRed,
             .published = Published{5.0, "5.0", "published"}});
  const std::string svg = drawn(panel);
  const auto diamonds = elements(svg, "polygon");
  ASSERT_EQ(diamonds.size(), 1u);
  const std::vector<Point> at = corners(diamonds[0]);
  ASSERT_EQ(at.size(), 4u);
  EXPECT_NEAR((at[0].x + at[2].x) / 2, 250, 0.01);
  EXPECT_NEAR((at[0].y + at[2].y) / 2, 100, 0.01);
  EXPECT_NE(svg.find(">5.0<"), std::string::npos);
  const auto legend = panel.legend();
  ASSERT_EQ(legend.size(), 2u);
  EXPECT_EQ(legend[1].name, "published");
}

TEST(Panel, AMarkStandsWhereItsPlaceIs) {
  Panel panel("", kX, kY);
  panel.mark({10, 5}, "B");
  const std::string svg = drawn(panel);
  EXPECT_NE(svg.find(">B<"), std::string::npos);
  const auto squares = elements(svg, "polygon");
  ASSERT_EQ(squares.size(), 1u);
  const std::vector<Point> at = corners(squares[0]);
  ASSERT_EQ(at.size(), 4u);
  EXPECT_NEAR((at[0].x + at[2].x) / 2, 200, 0.01);
  EXPECT_NEAR((at[0].y + at[2].y) / 2, 100, 0.01);
  EXPECT_TRUE(panel.legend().front().name.empty());
}

TEST(Panel, WhatIsNothingStandsAtTheZeroOfALogarithmicAxis) {
  Panel panel("", kX, {.scale = Scale::kLog, .low = 0.01, .high = 100.0, .none = 0.1});
  panel.points({{10, 0.1}}, kRed);
  const std::string svg = drawn(panel);
  const auto circles = elements(svg, "circle");
  ASSERT_EQ(circles.size(), 1u);
  EXPECT_EQ(value(circles[0], "cy"), 125.0);  // a quarter up from 150
  bool zero = false;
  for (const std::string& text : elements(svg, "text")) {
    const bool there = std::abs(value(text, "y") - 125.0) < 5.0 && value(text, "x") < 100.0;
    zero |= there && svg.find(text + "0<") != std::string::npos;
  }
  EXPECT_TRUE(zero);
}

TEST(Panel, ALabelGrowsAwayFromItsPointWhateverTheFont) {
  Panel panel("", kX, kY);
  panel.points({{10, 5}, {20, 5}}, kRed);
  panel.note({10, 5}, "right");
  panel.note({20, 5}, "left");
  const std::string svg = drawn(panel);
  int starts = 0, ends = 0;
  for (const std::string& text : elements(svg, "text")) {
    if (svg.find(text + "right<") != std::string::npos) {
      starts += attribute(text, "text-anchor") == "start" && value(text, "x") > 203.0;
    }
    if (svg.find(text + "left<") != std::string::npos) {
      ends += attribute(text, "text-anchor") == "end" && value(text, "x") < 297.0;
    }
  }
  EXPECT_GE(starts, 1);
  EXPECT_GE(ends, 1);
}

TEST(Panel, SharedAxesShowWhatAnyOfThemDoes) {
  std::vector<Panel> panels;
  for (const double size : {1.0, 10.0, 3.0}) {
    panels.emplace_back("", Axis{.label = "x"}, Axis{.label = "y"});
    panels.back().line({{-size, 0.0}, {1.0, 2.0 * size}}, kRed);
  }
  share_axes(each(panels));
  for (const Panel& panel : panels) {
    EXPECT_LE(panel.x_range().low, -10.0);
    EXPECT_GE(panel.y_range().high, 20.0);
    EXPECT_EQ(panel.x_range().low, panels[0].x_range().low);
    EXPECT_EQ(panel.y_range().high, panels[0].y_range().high);
  }
}

TEST(PanelLine, GoesThroughItsPoints) {
  Panel panel("", kX, kY);
  panel.line({{0, 0}, {10, 5}, {20, 0}}, kRed);
  const auto lines = having(elements(drawn(panel), "polyline"), "stroke", "#ff0000");
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(attribute(lines[0], "points"), "100,150 200,100 300,150");
}

TEST(PanelLine, BreaksWhereAValueCannotBeShown) {
  const Axis log = {.label = "y", .scale = Scale::kLog, .low = 1.0, .high = 100.0};
  for (const double gap : {kNotANumber, kFailedRank, -kFailedRank, 0.0, -1.0}) {
    Panel panel("", kX, log);
    panel.line({{0, 1}, {5, 10}, {10, gap}, {15, 10}, {20, 100}}, kRed);
    const std::string svg = drawn(panel);
    const auto lines = having(elements(svg, "polyline"), "stroke", "#ff0000");
    ASSERT_EQ(lines.size(), 2u) << gap;
    EXPECT_EQ(attribute(lines[0], "points"), "100,150 150,100");
    EXPECT_EQ(attribute(lines[1], "points"), "250,100 300,50");
  }
}

TEST(PanelLine, OfManyPointsIsThinned) {
  Panel panel("", kX, kY);
  std::vector<Point> many;
  for (int i = 0; i <= 100000; ++i) many.push_back({i * 20e-5, 5 + 4 * std::sin(i * 1e-4)});
  panel.line(many, kRed);
  EXPECT_LT(drawn(panel).size(), 20000u);
}

TEST(PanelPoints, HaveErrorBarsWithCapsOnlyWhereTheyEnd) {
  Panel panel("", kX, kY);
  panel.points({{10, 5}, {15, 5}}, kRed, "", {{4, 7}, {3, kFailedRank}});
  const std::string svg = drawn(panel);
  EXPECT_TRUE(has_line(svg, 200, 110, 200, 80));
  EXPECT_TRUE(has_line(svg, 196.5, 110, 203.5, 110));
  EXPECT_TRUE(has_line(svg, 196.5, 80, 203.5, 80));
  EXPECT_TRUE(has_line(svg, 250, 120, 250, 50)) << "runs out of the frame";
  EXPECT_FALSE(has_line(svg, 246.5, 50, 253.5, 50));
  EXPECT_EQ(elements(svg, "circle").size(), 2u);
}

TEST(PanelPoints, OutsideTheFrameAreNotDrawn) {
  Panel panel("", kX, kY);
  panel.points({{10, 11}, {-1, 5}, {kNotANumber, 5}, {10, kFailedRank}}, kRed);
  EXPECT_TRUE(elements(drawn(panel), "circle").empty());
}

TEST(PanelReference, IsADashedLineAcrossWithItsLabel) {
  Panel panel("", kX, kY);
  panel.reference(2.5, "limit");
  const std::string svg = drawn(panel);
  std::vector<std::string> dashed;
  for (const std::string& line : elements(svg, "line")) {
    if (!attribute(line, "stroke-dasharray").empty()) dashed.push_back(line);
  }
  ASSERT_EQ(dashed.size(), 1u);
  EXPECT_EQ(value(dashed[0], "x1"), 100);
  EXPECT_EQ(value(dashed[0], "x2"), 300);
  EXPECT_EQ(value(dashed[0], "y1"), 125);
  EXPECT_EQ(value(dashed[0], "y2"), 125);
  EXPECT_NE(svg.find(">limit<"), std::string::npos);
}

TEST(PanelEqualScale, MakesUnitsOfBothAxesTheSameLength) {
  for (const Point far : {Point{40, 5}, Point{5, 40}}) {
    Panel panel("", {.label = "x"}, {.label = "y"});
    panel.use_equal_scale();
    panel.line({{0, 0}, {1, 1}, far}, kRed);
    const auto lines = having(elements(drawn(panel), "polyline"), "stroke", "#ff0000");
    ASSERT_EQ(lines.size(), 1u);
    const std::vector<Point> at = corners(lines[0]);
    ASSERT_EQ(at.size(), 3u);
    const double per_x = (at[2].x - at[0].x) / far.x, per_y = (at[0].y - at[2].y) / far.y;
    EXPECT_NEAR(per_x, per_y, 0.01);
    EXPECT_GT(per_x, 2.0) << "as large as fits";
    for (const Point& p : at) EXPECT_TRUE(kPanelFrame.contains(p));
  }
}

TEST(PanelRange, HoldsAllDataAndDoesNotGoBelowZeroForNothing) {
  Panel panel("", {.label = "x"}, {.label = "y"});
  panel.points({{3, 0.1}, {90, 7}}, kRed, "", {{0.05, 1}, {6, 12}});
  panel.reference(15, "limit");
  const std::string svg = drawn(panel);
  EXPECT_EQ(elements(svg, "circle").size(), 2u);
  EXPECT_NE(svg.find(">limit<"), std::string::npos);
  EXPECT_EQ(svg.find("−"), std::string::npos) << "no negative tick";
}

TEST(PanelRange, HoldsWholeErrorBars) {
  Panel panel("", {.label = "x"}, {.label = "y"});
  panel.points({{1, 5}, {2, 6}}, kRed, "", {{-40, 5}, {6, 90}});
  int caps = 0;
  for (const std::string& line : having(elements(drawn(panel), "line"), "stroke", "#ff0000")) {
    caps += value(line, "y1") == value(line, "y2") ? 1 : 0;
  }
  EXPECT_EQ(caps, 4);
}

TEST(PanelRange, WithoutDataIsStillDrawn) {
  for (const Scale scale : {Scale::kLinear, Scale::kLog}) {
    Panel panel("empty", {.label = "x", .scale = scale}, {.label = "y", .scale = scale});
    panel.line({}, kRed);
    panel.points({{kNotANumber, kNotANumber}}, kRed);
    panel.box({.values = {}});
    const std::string svg = drawn(panel);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("inf"), std::string::npos);
    EXPECT_NE(svg.find(">empty<"), std::string::npos);
  }
}

}  // namespace
}  // namespace handrail::figure
