#include "server/constraint/drawn/outline_piece.h"

#include <algorithm>
#include <cmath>

namespace handrail {
namespace {

CarrierPoints none() { return {{Vec2::Zero(), Vec2::Zero()}, 0}; }

// The foot of the perpendicular from a circle's centre, and the points `half` to either side of it
// along `axis`; `beyond` is how far the foot lies outside the circle [m].
CarrierPoints chord(const Vec2& foot, const Vec2& axis, double half_squared, double beyond) {
  if (beyond > kBorderTolerance) return none();
  if (half_squared <= 0.0 || beyond > -kBorderTolerance * 1e-3) return {{foot, foot}, 1};
  const double half = std::sqrt(half_squared);
  return {{foot - half * axis, foot + half * axis}, 2};
}

CarrierPoints line_circle(const OutlinePiece& line, const OutlinePiece& circle) {
  const Vec2 foot = line.a + (circle.centre - line.a).dot(line.along) * line.along;
  const double off = (foot - circle.centre).norm();
  const double half_squared = (circle.radius - off) * (circle.radius + off);
  return chord(foot, line.along, half_squared, off - circle.radius);
}

CarrierPoints circle_circle(const OutlinePiece& u, const OutlinePiece& v) {
  const Vec2 between = v.centre - u.centre;
  const double d = between.norm();
  if (d <= kBorderTolerance) return none();  // concentric
  const Vec2 axis = between / d;
  const double x = 0.5 * (d + (u.radius - v.radius) * (u.radius + v.radius) / d);
  const double beyond = std::max(d - (u.radius + v.radius), std::abs(u.radius - v.radius) - d);
  const double half_squared = (u.radius - x) * (u.radius + x);
  return chord(u.centre + x * axis, left_of(axis), half_squared, beyond);
}

}  // namespace

OutlinePiece OutlinePiece::segment(const Vec2& a, const Vec2& b) {
  OutlinePiece piece;
  piece.a = a;
  piece.b = b;
  piece.length = (b - a).norm();
  if (piece.length > 0.0) piece.along = (b - a) / piece.length;
  return piece;
}

OutlinePiece OutlinePiece::arc(const Vec2& centre, double radius, const Vec2& a, const Vec2& b,
                               int turn) {
  OutlinePiece piece;
  piece.a = a;
  piece.b = b;
  piece.turn = turn;
  piece.centre = centre;
  piece.radius = radius;
  return piece;
}

OutlinePiece OutlinePiece::part(const Vec2& from, const Vec2& to) const {
  return turn == 0 ? segment(from, to) : arc(centre, radius, from, to, turn);
}

double OutlinePiece::travel(const Vec2& p) const {
  if (turn == 0) return (p - a).dot(along);
  const Vec2 u = a - centre, v = p - centre;
  return radius * turn * std::atan2(cross(u, v), u.dot(v));
}

Vec2 OutlinePiece::at(double travel) const {
  return turn == 0 ? Vec2(a + travel * along)
                   : Vec2(centre + Pose2::turned(a - centre, turn * travel / radius));
}

double OutlinePiece::size() const { return turn == 0 ? length : travel(b); }

Vec2 OutlinePiece::nearest_on_carrier(const Vec2& x) const noexcept {
  if (turn == 0) return a + (x - a).dot(along) * along;
  const Vec2 v = x - centre;
  const double d = v.norm();
  return d > 0.0 ? Vec2(centre + radius / d * v) : a;
}

Vec2 OutlinePiece::nearest(const Vec2& x) const noexcept {
  Vec2 p = nearest_on_carrier(x);
  if (spans(p, 0.0)) return p;
  return (x - a).squaredNorm() <= (x - b).squaredNorm() ? a : b;
}

CarrierPoints meet(const OutlinePiece& u, const OutlinePiece& v) {
  if (u.turn != 0 && v.turn != 0) return circle_circle(u, v);
  if (u.turn != 0) return line_circle(v, u);
  if (v.turn != 0) return line_circle(u, v);
  const double sine = cross(u.along, v.along);
  if (std::abs(sine) < 1e-9) return none();
  const Vec2 p = u.a + cross(v.a - u.a, v.along) / sine * u.along;
  return {{p, p}, 1};
}

}  // namespace handrail
