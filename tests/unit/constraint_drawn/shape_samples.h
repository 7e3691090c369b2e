// Drawn walls, and what they allow worked out a second way, for tests and benchmarks.
#pragma once

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "server/base/units.h"
#include "server/model/walls.h"

namespace handrail::test {

inline constexpr double kQuarter = 0.5 * std::numbers::pi;

inline WallShape box(const Vec2& centre, const Vec2& half, double angle = 0.0) {
  WallShape shape;
  shape.kind = WallShape::Kind::kRectangle;
  shape.centre = centre;
  shape.half = half;
  shape.angle = angle;
  return shape;
}

inline WallShape disc(const Vec2& centre, double radius) {
  WallShape shape;
  shape.kind = WallShape::Kind::kDisc;
  shape.centre = centre;
  shape.radius = radius;
  return shape;
}

inline WallShape arc_aisle(const Vec2& centre, double radius, double width, double from,
                           double to) {
  WallShape shape;
  shape.kind = WallShape::Kind::kArc;
  shape.centre = centre;
  shape.radius = radius;
  shape.width = width;
  shape.from = from;
  shape.to = to;
  return shape;
}

inline WallShape ring(const Vec2& centre, double radius, double width) {
  return arc_aisle(centre, radius, width, 0.0, 4.0 * kQuarter);
}

inline WallShape in_region(WallShape shape, std::uint8_t region) {
  shape.region = region;
  return shape;
}

// Regions: 0 and 1 aisles, 2 the wall around them. The scene starts at the first shape's middle.
inline Walls drawn(std::vector<WallShape> shapes, double fillet = 0.0) {
  Walls walls;
  walls.method = WallMethod::kExact;
  walls.regions.resize(3);
  walls.regions[0].kind = walls.regions[1].kind = RegionKind::kAisle;
  walls.regions[2].kind = RegionKind::kWall;
  walls.outside = 2;
  walls.fillet = fillet;
  walls.stages = {WallStage()};
  const WallShape& first = shapes.front();
  walls.start = first.centre;
  if (first.kind == WallShape::Kind::kArc) {
    walls.start += Pose2::turned({first.radius, 0.0}, 0.5 * (first.from + first.to));
  }
  walls.shapes = std::move(shapes);
  return walls;
}

// A lane of 10 mm along X crossed by one along Y, 100 mm long each.
inline Walls crossing(double fillet = 0.0) {
  return drawn({box({0, 0}, {0.05, 0.005}), box({0, 0}, {0.005, 0.05})}, fillet);
}

// A lane from x = 0, 1 mm a step, whose upper wall rises 10 um a step from 2 mm.
inline Walls stairs(int steps) {
  std::vector<WallShape> shapes;
  for (int i = 0; i < steps; ++i) {
    const double half = 1e-3 + 5e-6 * i;
    shapes.push_back(box({(i + 0.5) * kMm, half}, {0.5 * kMm, half}));
  }
  return drawn(shapes);
}

// One horizontal and three vertical lanes of 8 mm with round ends, six gears.
inline Walls gear_lanes(double fillet = 0.0) {
  std::vector<WallShape> shapes = {box({0, 0}, {0.04, 0.004})};
  for (const double x : {-0.04, 0.0, 0.04}) {
    shapes.push_back(box({x, 0}, {0.004, 0.03}));
    for (const double y : {-0.03, 0.03}) shapes.push_back(disc({x, y}, 0.004));
  }
  return drawn(shapes, fillet);
}

// Whether x is in the shape grown by `slack`, from polar and Cartesian coordinates alone.
inline bool holds(const WallShape& shape, const Vec2& x, double slack) {
  const double dx = x.x() - shape.centre.x(), dy = x.y() - shape.centre.y();
  const double distance = std::hypot(dx, dy);
  if (shape.kind == WallShape::Kind::kDisc) return distance <= shape.radius + slack;
  if (shape.kind == WallShape::Kind::kRectangle) {
    const double c = std::cos(shape.angle), s = std::sin(shape.angle);
    return std::abs(c * dx + s * dy) <= shape.half.x() + slack &&
           std::abs(c * dy - s * dx) <= shape.half.y() + slack;
  }
  if (std::abs(distance - shape.radius) > 0.5 * shape.width + slack) return false;
  if (distance <= slack) return true;
  double angle = std::fmod(std::atan2(dy, dx) - shape.from, 4.0 * kQuarter);
  if (angle < 0.0) angle += 4.0 * kQuarter;
  const double span = shape.to - shape.from, wide = slack / std::max(distance, 1e-6);
  return angle <= span + wide || angle >= 4.0 * kQuarter - wide;
}

// Whether x is free, fillets aside.
inline bool holds(const Walls& walls, const Vec2& x, double slack) {
  for (const WallShape& shape : walls.shapes) {
    if (holds(shape, x, slack)) return true;
  }
  return false;
}

// Greatest decrease of the distance to `hand` that a straight way of 1 um from `p` within free
// space gives [m]; up to 1e-12/(2 R) beside a round wall of radius R.
inline double gain_nearby(const Walls& walls, const Vec2& p, const Vec2& hand) {
  constexpr int kDirections = 360, kSteps = 8;
  double gain = 0.0;
  for (int i = 0; i < kDirections; ++i) {
    const Vec2 step =
        1e-6 / kSteps * Pose2::turned(Vec2::UnitX(), 4.0 * kQuarter * i / kDirections);
    int k = 0;
    while (k < kSteps && holds(walls, p + (k + 1) * step, 1e-12)) ++k;
    gain = std::max(gain, (p - hand).norm() - (p + k * step - hand).norm());
  }
  return gain;
}

}  // namespace handrail::test
