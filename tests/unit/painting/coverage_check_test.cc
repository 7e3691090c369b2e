#include "server/painting/coverage_check.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/wall_samples.h"

namespace handrail {
namespace {

using test::rectangle;
using test::WallPainter;

constexpr int kCheckSize = 120;
constexpr double kPixel = 1e-4;

// Lengths in pixels, the origin in the middle, Y up.
Vec2 px(double x, double y) { return Vec2(x, y) * kPixel; }
test::Polygon box(double x, double y, double length, double width, double deg = 0.0) {
  return rectangle(px(x, y), length * kPixel, width * kPixel, deg * std::numbers::pi / 180);
}
WallPainter wall_everywhere() { return {kCheckSize, kCheckSize, kPixel, false}; }

TEST(MapCheck, FindsNothingWrongWithAnOrdinaryMap) {
  const MapCheck check = check_map(
      wall_everywhere().open(box(0, 0, 80, 40, 17)).wall(box(0, 0, 20, 9, 40)).finish(px(-30, 0)));
  EXPECT_EQ(check.problem, "");
  EXPECT_TRUE(check.warnings.empty()) << check.warnings.front();
}

TEST(MapCheck, RefusesAStartInAWallOrOutsideTheMap) {
  const WallPainter painter = wall_everywhere().open(box(0, 0, 80, 40));
  EXPECT_EQ(check_map(painter.finish(px(0, 30.5))).problem,
            "the start 0, 3.05 mm is inside the wall 'wall', pixel (60, 29)");
  EXPECT_EQ(check_map(painter.finish(px(61, 0))).problem, "the start 6.1, 0 mm is outside the map");
  EXPECT_EQ(check_map(painter.finish(px(0, 19.5))).problem, "");
}

TEST(MapCheck, RefusesAStartThatTheWallSealsOff) {
  const Walls walls =
      wall_everywhere().open(box(-20, 0, 8, 8)).open(box(30, 0, 30, 80)).finish(px(-20, 0));
  EXPECT_EQ(check_map(walls).problem, "");
  EXPECT_EQ(
      check_map(walls).warnings,
      std::vector<std::string>{"24 mm^2 of free space cannot be reached from the start, first "
                               "at pixel (75, 20), 1.55, 3.95 mm"});
  const Walls sealed =
      wall_everywhere().open(box(-20, 0, 4, 4)).open(box(30, 0, 30, 80)).finish(px(-20, 0));
  EXPECT_EQ(check_map(sealed).problem,
            "the wall seals the start off: it reaches 0.16 mm^2 of 24.16 mm^2 of free space");
}

// Two rooms; the right one an aisle, a gate between them.
Walls rooms(bool gate) {
  WallPainter painter = wall_everywhere();
  const std::uint8_t lane = painter.add_region("lane", RegionKind::kAisle);
  const std::uint8_t door = painter.add_region("door", RegionKind::kWall);
  painter.open(box(0, 0, 80, 40));
  if (gate) painter.wall(box(0, 0, 6, 40), door);
  Walls walls = painter.finish(px(-30, 0));
  auto map = std::make_shared<CoverageMap>(*walls.map);
  for (std::size_t i = 0; i < map->region.size(); ++i) {
    if (i % kCheckSize > 63 && map->region[i] == 0) map->region[i] = lane;
  }
  walls.map = map;
  return walls;
}

TEST(MapCheck, RefusesAnAisleOutOfReach) {
  EXPECT_EQ(check_map(rooms(false)).problem, "");
  EXPECT_EQ(check_map(rooms(true)).problem,
            "the wall seals the start off: it reaches 14.8 mm^2 of 29.6 mm^2 of free space and "
            "nothing of aisle 'lane'");
}

TEST(MapCheck, AnAisleMayOpenAtALaterStage) {
  Walls walls = rooms(true);
  WallStage open;
  open.gone = {3};
  walls.stages.push_back(open);
  EXPECT_EQ(check_map(walls).problem, "");
}

std::vector<std::string> warnings_of(const WallPainter& painter, const Vec2& start) {
  return check_map(painter.finish(start)).warnings;
}

// The width that a warning states [pixels], 0 when its millimetres are others.
double measured(const std::string& warning) {
  const std::string before = ": it measures ", between = " pixels (";
  const std::size_t from = warning.find(before), to = warning.find(between);
  if (from == std::string::npos || to == std::string::npos) return 0.0;
  const double px = std::stod(warning.substr(from + before.size()));
  const double mm = std::stod(warning.substr(to + between.size()));
  return std::abs(mm - 1e3 * kPixel * px) < 6e-3 ? px : 0.0;
}

TEST(MapCheck, WarnsOfAislesThatAreNotOpen) {
  const auto slit = [](double width) {
    return warnings_of(
        wall_everywhere().open(box(0, 0, 40, 40)).open(box(35, 0.5 * width + 0.3, 30, width)),
        px(0, 0));
  };
  EXPECT_EQ(slit(0.4),
            (std::vector<std::string>{
                "an aisle is narrower than one pixel at pixel (82, 59), 2.25, 0.05 mm: it measures "
                "0.4 pixels (0.04 mm) there, nothing of it is left open"}));
  ASSERT_EQ(slit(0.6).size(), 1U);
  EXPECT_TRUE(slit(0.6)[0].starts_with("an aisle is narrower than two pixels")) << slit(0.6)[0];
}

TEST(MapCheck, WarnsOfAislesNarrowerThanTwoPixelsAtAnyAngle) {
  for (const double angle : {0.0, 12.0, 22.5, 45.0, 67.0, 90.0}) {
    for (const double width : {1.2, 1.5, 1.9}) {
      const auto found =
          warnings_of(wall_everywhere().open(box(0.3, 0.2, 60, width, angle)), px(0.5, 0.5));
      ASSERT_GE(found.size(), 1U) << angle << " deg, " << width << " px";
      EXPECT_TRUE(found.back().starts_with("an aisle is narrower than two pixels at pixel ("))
          << found.back();
      EXPECT_TRUE(found.back().ends_with(" its walls will not be felt where they were drawn"));
      EXPECT_NEAR(measured(found.back()), width, 0.2) << found.back();
    }
    const auto wide = warnings_of(wall_everywhere().open(box(0.3, 0.2, 60, 2.2, angle)), px(0, 0));
    EXPECT_TRUE(wide.empty()) << angle << " deg: " << wide.front();
  }
}

TEST(MapCheck, WarnsOfWallsThinnerThanOnePixelAtAnyAngle) {
  for (const double angle : {0.0, 12.0, 22.5, 45.0, 67.0, 90.0}) {
    for (const double width : {0.5, 0.9}) {
      const auto found = warnings_of(
          wall_everywhere().open(box(0, 0, 100, 100)).wall(box(0.3, 0.2, 60, width, angle)),
          px(-40, -40));
      ASSERT_EQ(found.size(), 1U) << angle << " deg, " << width << " px";
      EXPECT_TRUE(found[0].starts_with("a wall is thinner than one pixel at pixel (")) << found[0];
      EXPECT_TRUE(found[0].ends_with(width < 0.75 ? " a fast hand may pass it, and a slow one"
                                                  : " a fast hand may pass it"));
      EXPECT_NEAR(measured(found[0]), width, 0.1) << found[0];
    }
    const auto thick =
        warnings_of(wall_everywhere().open(box(0, 0, 100, 100)).wall(box(0.3, 0.2, 60, 1.1, angle)),
                    px(-40, -40));
    EXPECT_TRUE(thick.empty()) << angle << " deg: " << thick.front();
  }
}

TEST(MapCheck, TakesNoCornerForAThinWall) {
  for (double angle = 0.0; angle < 90.0; angle += 7.0) {
    const auto found = warnings_of(
        wall_everywhere().open(box(0, 0, 70, 70, angle)).wall(box(0, 0, 30, 30, angle + 31.0)),
        px(-27, 0));
    EXPECT_TRUE(found.empty()) << angle << " deg: " << found.front();
  }
}

}  // namespace
}  // namespace handrail
