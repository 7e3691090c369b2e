#include "server/lab/accuracy/wall_course.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "server/base/units.h"
#include "server/lab/accuracy/wall_painter.h"

namespace handrail {
namespace {

struct Aisle {
  Vec2 centre;
  double length, width, angle;
};

// Nothing lies on a pixel's edge at any of the pixels measured.
const Vec2 kRing(-12.013 * kMm, 0.021 * kMm);
constexpr double kOuter = 10.0 * kMm, kInner = 6.0 * kMm;
const std::array<Aisle, 3> kAisles = {
    {{{15.0 * kMm, 8.0 * kMm}, 18.0 * kMm, 3.0 * kMm, 17 * kDeg},
     {{8.0 * kMm, -5.0 * kMm}, 12.0 * kMm, 3.0 * kMm, 62 * kDeg},
     {{19.0 * kMm, -4.0 * kMm}, 12.0 * kMm, 3.0 * kMm, 101 * kDeg}}};
constexpr double kMapWidth = 56.0 * kMm, kMapHeight = 30.0 * kMm;
constexpr int kLevels = 256;               // of coverage, what a pixel of 8 bits can say
constexpr double kFromCorner = 2.5 * kMm;  // 6 of the largest pixels

Vec2 unit(double angle) { return {std::cos(angle), std::sin(angle)}; }

// There and back over `length`: where a way of that size has come to.
double there_and_back(double way, double length) {
  const double rest = std::fmod(way, 2.0 * length);
  return rest < length ? rest : 2.0 * length - rest;
}

WallCourse round_course(double surface, double hand_radius) {
  WallCourse out;
  out.circle = true;
  out.centre = kRing;
  out.surface = surface;
  out.hand_radius = hand_radius;
  out.length = 2.0 * std::numbers::pi * hand_radius;
  return out;
}

std::vector<WallCourse> make_courses() {
  std::vector<WallCourse> out = {round_course(kOuter, kOuter + kCourseDepth),
                                 round_course(kInner, kInner - kCourseDepth)};
  for (const Aisle& aisle : kAisles) {
    for (const double side : {-1.0, 1.0}) {
      WallCourse course;
      course.along = unit(aisle.angle);
      course.out = -side * Vec2(-course.along.y(), course.along.x());
      course.length = aisle.length - 2.0 * kFromCorner;
      course.centre =
          aisle.centre - 0.5 * course.length * course.along - 0.5 * aisle.width * course.out;
      out.push_back(course);
    }
  }
  return out;
}

}  // namespace

Vec2 WallCourse::hand(double way) const {
  if (circle) return centre + hand_radius * unit(way / hand_radius);
  return centre + there_and_back(way, length) * along - kCourseDepth * out;
}

Vec2 WallCourse::foot(double way) const {
  if (circle) return centre + surface * unit(way / hand_radius);
  return centre + there_and_back(way, length) * along;
}

Vec2 WallCourse::free_at(double way) const {
  const Vec2 at = foot(way);
  return at + (at - hand(way));
}

double WallCourse::off_surface(const Vec2& p) const {
  if (!circle) return (p - centre).dot(out);
  const double outward = (p - centre).norm() - surface;
  return hand_radius > surface ? -outward : outward;
}

Walls course_shapes() {
  Walls walls;
  walls.method = WallMethod::kExact;
  walls.regions.resize(2);
  walls.regions[1].kind = RegionKind::kWall;
  walls.regions[1].stiffness = kCourseStiffness;
  walls.outside = 1;
  for (const Aisle& aisle : kAisles) {
    WallShape shape;
    shape.centre = aisle.centre;
    shape.half = 0.5 * Vec2(aisle.length, aisle.width);
    shape.angle = aisle.angle;
    walls.shapes.push_back(shape);
  }
  WallShape ring;
  ring.kind = WallShape::Kind::kArc;
  ring.centre = kRing;
  ring.radius = 0.5 * (kOuter + kInner);
  ring.width = kOuter - kInner;
  ring.to = 2.0 * std::numbers::pi;
  walls.shapes.push_back(ring);
  walls.start = kAisles[0].centre;
  walls.stages.resize(1);
  return walls;
}

Walls course_painting(double pixel) {
  paint::WallPainter painter(static_cast<int>(std::lround(kMapWidth / pixel)),
                             static_cast<int>(std::lround(kMapHeight / pixel)), pixel, false);
  painter.open_disc(kRing, kOuter).wall_disc(kRing, kInner);
  for (const Aisle& aisle : kAisles) {
    painter.open(paint::rectangle(aisle.centre, aisle.length, aisle.width, aisle.angle));
  }
  Walls walls = painter.finish(kAisles[0].centre, kLevels);
  walls.regions[1].stiffness = kCourseStiffness;
  return walls;
}

const std::vector<WallCourse>& wall_courses() {
  static const std::vector<WallCourse> courses = make_courses();
  return courses;
}

}  // namespace handrail
