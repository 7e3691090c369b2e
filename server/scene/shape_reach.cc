#include "server/scene/shape_reach.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace handrail {
namespace {

constexpr double kTouch = 1e-9;  // [m]
constexpr int kMostSteps = 500;  // of samples along one side

using Kind = WallShape::Kind;

// The shape's width across, the smallest size of anything that can pass it.
double narrow_side(const WallShape& s) {
  if (s.kind == Kind::kRectangle) return 2.0 * s.half.minCoeff();
  return s.kind == Kind::kDisc ? 2.0 * s.radius : s.width;
}

// The point at shares u, v (0 to 1) of the shape's two directions.
Vec2 point_at(const WallShape& s, double u, double v) {
  if (s.kind == Kind::kRectangle) {
    const Vec2 local((2.0 * u - 1.0) * s.half.x(), (2.0 * v - 1.0) * s.half.y());
    return s.centre + Pose2::turned(local, s.angle);
  }
  const bool disc = s.kind == Kind::kDisc;
  const double angle = disc ? 2.0 * std::numbers::pi * u : s.from + u * (s.to - s.from);
  const double radius = disc ? s.radius * v : s.radius + (v - 0.5) * s.width;
  return s.centre + radius * Vec2(std::cos(angle), std::sin(angle));
}

Vec2 sides(const WallShape& s) {
  if (s.kind == Kind::kRectangle) return 2.0 * s.half;
  if (s.kind == Kind::kDisc) return {2.0 * std::numbers::pi * s.radius, s.radius};
  return {(s.radius + 0.5 * s.width) * (s.to - s.from), s.width};
}

// Whether a sample of `a` lies in `b`.
bool reaches_into(const WallShape& a, const WallShape& b) {
  const double step = 0.5 * std::min(narrow_side(a), narrow_side(b));
  const Vec2 side = sides(a);
  const auto steps = [&](double length) {
    return std::clamp(static_cast<int>(std::ceil(length / step)), 2, kMostSteps);
  };
  const int n = steps(side.x()), m = steps(side.y());
  for (int i = 0; i <= n; ++i) {
    for (int k = 0; k <= m; ++k) {
      if (is_inside(b, point_at(a, static_cast<double>(i) / n, static_cast<double>(k) / m))) {
        return true;
      }
    }
  }
  return false;
}

bool apart(const WallShape& a, const WallShape& b) {
  const auto reach = [](const WallShape& s) {
    return s.kind == Kind::kRectangle ? s.half.norm() : s.radius + 0.5 * s.width;
  };
  return (a.centre - b.centre).norm() > reach(a) + reach(b) + kTouch;
}

}  // namespace

bool is_inside(const WallShape& shape, const Vec2& p) noexcept {
  const Vec2 d = p - shape.centre;
  if (shape.kind == Kind::kRectangle) {
    const Vec2 local = Pose2::turned(d, -shape.angle);
    return std::abs(local.x()) <= shape.half.x() + kTouch &&
           std::abs(local.y()) <= shape.half.y() + kTouch;
  }
  const double r = d.norm();
  if (shape.kind == Kind::kDisc) return r <= shape.radius + kTouch;
  if (std::abs(r - shape.radius) > 0.5 * shape.width + kTouch) return false;
  if (r <= kTouch) return true;
  constexpr double kTurn = 2.0 * std::numbers::pi;
  double past = std::fmod(std::atan2(d.y(), d.x()) - shape.from, kTurn);
  if (past < 0.0) past += kTurn;
  const double slack = kTouch / r;
  return past <= shape.to - shape.from + slack || past >= kTurn - slack;
}

std::vector<bool> shapes_reached(const std::vector<WallShape>& shapes, const Vec2& start) {
  std::vector<bool> reached(shapes.size(), false);
  std::vector<std::size_t> waiting;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (!is_inside(shapes[i], start)) continue;
    reached[i] = true;
    waiting.push_back(i);
  }
  while (!waiting.empty()) {
    const WallShape& from = shapes[waiting.back()];
    waiting.pop_back();
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      if (reached[i] || apart(from, shapes[i])) continue;
      if (!reaches_into(from, shapes[i]) && !reaches_into(shapes[i], from)) continue;
      reached[i] = true;
      waiting.push_back(i);
    }
  }
  return reached;
}

}  // namespace handrail
