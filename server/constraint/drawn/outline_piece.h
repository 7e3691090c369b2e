// One piece of the border between free space and wall: a segment or an arc. Map frame, SI. Pure.
#pragma once

#include <array>

#include "server/base/plane.h"

namespace handrail {

// Borders closer than this are one: shapes that touch within it are joined [m].
inline constexpr double kBorderTolerance = 1e-8;

inline double cross(const Vec2& u, const Vec2& v) { return u.x() * v.y() - u.y() * v.x(); }
// A quarter turn counter-clockwise.
inline Vec2 left_of(const Vec2& v) { return {-v.y(), v.x()}; }

// From `a` to `b` with free space on the left. An arc spans less than half a circle.
struct OutlinePiece {
  Vec2 a = Vec2::Zero(), b = Vec2::Zero();
  int turn = 0;  // 0: segment; +1: arc, counter-clockwise, free inside; -1: clockwise, wall inside
  Vec2 centre = Vec2::Zero();  // arc
  double radius = 0.0;         // arc
  Vec2 along = Vec2::UnitX();  // segment: unit, from a to b
  double length = 0.0;         // segment [m]

  static OutlinePiece segment(const Vec2& a, const Vec2& b);
  // The part of the circle from a to b, both on it.
  static OutlinePiece arc(const Vec2& centre, double radius, const Vec2& a, const Vec2& b,
                          int turn);
  // This piece's part between two of its points.
  OutlinePiece part(const Vec2& from, const Vec2& to) const;

  // Of the carrier at one of its points: the direction of travel, and out of the wall. Units.
  Vec2 tangent(const Vec2& p) const noexcept {
    return turn == 0 ? along : Vec2(left_of(p - centre) * (turn / radius));
  }
  Vec2 normal(const Vec2& p) const noexcept {
    return turn == 0 ? left_of(along) : Vec2((centre - p) * (turn / radius));
  }
  // Distance travelled from a to the carrier's point p [m]; on an arc between minus and plus half
  // a circle.
  double travel(const Vec2& p) const;
  Vec2 at(double travel) const;
  double size() const;  // travel to b [m]

  // Whether a point of the carrier lies between a and b, or within `slack` of it [m].
  bool spans(const Vec2& p, double slack) const noexcept {
    if (turn == 0) {
      const double s = (p - a).dot(along);
      return s >= -slack && s <= length + slack;
    }
    const double limit = -slack * radius;
    return turn * cross(a - centre, p - centre) >= limit &&
           turn * cross(p - centre, b - centre) >= limit;
  }
  Vec2 nearest_on_carrier(const Vec2& x) const noexcept;
  Vec2 nearest(const Vec2& x) const noexcept;
  // Distance of x from the carrier, positive on the free side [m].
  double carrier_distance(const Vec2& x) const noexcept {
    return turn == 0 ? cross(along, x - a) : turn * (radius - (x - centre).norm());
  }
};

// The points two carriers share: none, one where they touch, or two.
struct CarrierPoints {
  std::array<Vec2, 2> p;
  int count = 0;
};
CarrierPoints meet(const OutlinePiece& u, const OutlinePiece& v);

}  // namespace handrail
