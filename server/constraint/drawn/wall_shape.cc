#include "server/constraint/drawn/wall_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace handrail {
namespace {

constexpr double kPi = std::numbers::pi;

Vec2 unit(double angle) { return {std::cos(angle), std::sin(angle)}; }

bool is_ring(const WallShape& arc) { return arc.to - arc.from >= 2.0 * kPi - 1e-9; }

// How far x is outside an aisle's two flat ends.
double outside_ends_by(const WallShape& arc, const Vec2& v) noexcept {
  const double half = 0.5 * (arc.to - arc.from);
  // Seen from the middle of the aisle both ends are alike.
  const Vec2 w = Pose2::turned(v, -0.5 * (arc.from + arc.to));
  return cross(unit(half), Vec2(w.x(), std::abs(w.y())));
}

void append_arc(std::vector<OutlinePiece>& border, const Vec2& centre, double radius, double from,
                double to, int turn) {
  // From `from` to `to` in steps of at most 120 degrees, whichever way they turn.
  const int parts = std::max(1, static_cast<int>(std::ceil(std::abs(to - from) / (kPi / 1.5))));
  Vec2 a = centre + radius * unit(from);
  for (int i = 1; i <= parts; ++i) {
    const Vec2 b = centre + radius * unit(from + (to - from) * i / parts);
    border.push_back(OutlinePiece::arc(centre, radius, a, b, turn));
    a = b;
  }
}

void append_arc_aisle(std::vector<OutlinePiece>& border, const WallShape& shape) {
  const double outer = shape.radius + 0.5 * shape.width;
  const double inner = shape.radius - 0.5 * shape.width;
  const bool pie = inner <= kBorderTolerance;
  const bool ring = is_ring(shape);
  const double to = ring ? shape.from + 2.0 * kPi : shape.to;
  const auto tip = [&](double angle) -> Vec2 {
    return pie ? shape.centre : Vec2(shape.centre + inner * unit(angle));
  };
  append_arc(border, shape.centre, outer, shape.from, to, +1);
  if (!ring) {
    border.push_back(OutlinePiece::segment(shape.centre + outer * unit(to), tip(to)));
  }
  if (!pie) append_arc(border, shape.centre, inner, to, shape.from, -1);
  if (!ring) {
    border.push_back(
        OutlinePiece::segment(tip(shape.from), shape.centre + outer * unit(shape.from)));
  }
}

}  // namespace

double outside_by(const WallShape& shape, const Vec2& x) noexcept {
  const Vec2 v = x - shape.centre;
  if (shape.kind == WallShape::Kind::kDisc) return v.norm() - shape.radius;
  if (shape.kind == WallShape::Kind::kRectangle) {
    const Vec2 over = Pose2::turned(v, -shape.angle).cwiseAbs() - shape.half;
    return over.maxCoeff();
  }
  const double across = std::abs(v.norm() - shape.radius) - 0.5 * shape.width;
  return is_ring(shape) ? across : std::max(across, outside_ends_by(shape, v));
}

std::vector<OutlinePiece> border_of(const WallShape& shape) {
  std::vector<OutlinePiece> border;
  switch (shape.kind) {
    case WallShape::Kind::kRectangle: {
      const Pose2 pose{shape.centre, shape.angle};
      const double x = shape.half.x(), y = shape.half.y();
      const Vec2 corners[] = {pose.to_world({-x, -y}), pose.to_world({x, -y}),
                              pose.to_world({x, y}), pose.to_world({-x, y})};
      for (std::size_t i = 0; i < 4; ++i) {
        border.push_back(OutlinePiece::segment(corners[i], corners[(i + 1) % 4]));
      }
      break;
    }
    case WallShape::Kind::kDisc:
      append_arc(border, shape.centre, shape.radius, 0.0, 2.0 * kPi, +1);
      break;
    case WallShape::Kind::kArc: append_arc_aisle(border, shape); break;
  }
  return border;
}

}  // namespace handrail
