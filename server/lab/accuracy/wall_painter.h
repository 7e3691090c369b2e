// Walls painted with exact-area linear coverage: what a perfect editor would export.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "server/model/walls.h"

namespace handrail::paint {

using Polygon = std::vector<Vec2>;  // corners counter-clockwise, simple; map frame [m]

// The rectangle about `centre`, sides `length` along its own X and `width` [m], turned by `angle`.
inline Polygon rectangle(const Vec2& centre, double length, double width, double angle) {
  const Vec2 x = 0.5 * length * Vec2(std::cos(angle), std::sin(angle));
  const Vec2 y = 0.5 * width * Vec2(-std::sin(angle), std::cos(angle));
  return {centre - x - y, centre + x - y, centre + x + y, centre - x + y};
}

// The half-plane behind the line through `point`: `normal` (unit) points out of it. `reach`: how
// far from the point it is needed [m].
inline Polygon half_plane(const Vec2& point, const Vec2& normal, double reach = 10.0) {
  return rectangle(point - 0.5 * reach * normal, reach, 2.0 * reach,
                   std::atan2(normal.y(), normal.x()));
}

// Area of the polygon, counter-clockwise positive.
inline double area_of(const Polygon& p) {
  double twice = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec2 &a = p[i], &b = p[(i + 1) % p.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

// The part of the unit square from (x, y) that is in the polygon. Source: Sutherland and Hodgman
// 1974; edges it doubles along the square's sides have no area.
inline double polygon_in_square(const Polygon& p, double x, double y) {
  Polygon in, out = p;
  for (int side = 0; side < 4 && !out.empty(); ++side) {
    in.swap(out);
    out.clear();
    const int axis = side / 2;
    const double sign = side % 2 == 0 ? 1.0 : -1.0;
    const double limit = (axis == 0 ? x : y) + (side % 2 == 0 ? 0.0 : 1.0);
    for (std::size_t i = 0; i < in.size(); ++i) {
      const Vec2 &a = in[i], &b = in[(i + 1) % in.size()];
      const double da = sign * (a[axis] - limit), db = sign * (b[axis] - limit);
      if (da >= 0.0) out.push_back(a);
      if ((da >= 0.0) != (db >= 0.0)) out.push_back(a + da / (da - db) * (b - a));
    }
  }
  for (Vec2& v : out) v -= Vec2(x, y);
  return std::clamp(area_of(out), 0.0, 1.0);
}

// The part of the unit square from (x, y) that is in the disc: per side of the square, triangle
// where it runs inside the circle and sector where outside (Green's theorem).
inline double disc_in_square(const Vec2& centre, double r, double x, double y) {
  const auto cross = [](const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); };
  const auto sector = [&](const Vec2& a, const Vec2& b) {
    return 0.5 * r * r * std::atan2(cross(a, b), a.dot(b));
  };
  double area = 0.0;
  const Vec2 corner[4] = {{x, y}, {x + 1.0, y}, {x + 1.0, y + 1.0}, {x, y + 1.0}};
  for (int i = 0; i < 4; ++i) {
    const Vec2 a = corner[i] - centre, b = corner[(i + 1) % 4] - centre, d = b - a;
    const double half_b = a.dot(d), c = a.squaredNorm() - r * r, root = half_b * half_b - c;
    double t0 = -half_b - std::sqrt(std::max(root, 0.0));
    double t1 = -half_b + std::sqrt(std::max(root, 0.0));
    if (root <= 0.0 || t1 <= 0.0 || t0 >= 1.0) {
      area += sector(a, b);
      continue;
    }
    t0 = std::max(t0, 0.0);
    t1 = std::min(t1, 1.0);
    const Vec2 p = a + t0 * d, q = a + t1 * d;
    area += sector(a, p) + 0.5 * cross(p, q) + sector(q, b);
  }
  return std::clamp(area, 0.0, 1.0);
}

// A map under the brush. Shapes add to what is there: exact as long as no pixel holds the edges of
// two shapes that overlap in it. Region 0 is free space, region 1 a wall; further ones by `wall`.
class WallPainter {
 public:
  WallPainter(int width, int height, double pixel, bool open = true) {
    map_.width = width;
    map_.height = height;
    map_.pixel = pixel;
    open_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                 open ? 1.0 : 0.0);
    map_.wall.assign(open_.size(), 1);
    regions_ = {region("free", RegionKind::kFree), region("wall", RegionKind::kWall)};
  }

  // A further region; returns its index.
  std::uint8_t add_region(const std::string& name, RegionKind kind) {
    regions_.push_back(region(name, kind));
    return static_cast<std::uint8_t>(regions_.size() - 1);
  }

  WallPainter& wall(const Polygon& p, std::uint8_t id = 1) { return paint_polygon(p, -1.0, id); }
  WallPainter& open(const Polygon& p) { return paint_polygon(p, 1.0, 0); }
  WallPainter& wall_disc(const Vec2& c, double r, std::uint8_t id = 1) {
    return paint_disc(c, r, -1.0, id);
  }
  WallPainter& open_disc(const Vec2& c, double r) { return paint_disc(c, r, 1.0, 0); }

  // The painted walls; `levels`: of coverage per pixel (256 as of an 8-bit image; 0: all 65536).
  Walls finish(const Vec2& start = Vec2::Zero(), int levels = 0) const {
    Walls walls;
    walls.regions = regions_;
    walls.start = start;
    walls.stages = {WallStage()};
    CoverageMap map = map_;
    map.open.reserve(open_.size());
    map.region.reserve(open_.size());
    for (std::size_t i = 0; i < open_.size(); ++i) {
      double share = std::clamp(open_[i], 0.0, 1.0);
      if (levels > 1) share = std::round(share * (levels - 1)) / (levels - 1);
      map.open.push_back(static_cast<std::uint16_t>(std::lround(share * 65535.0)));
      map.region.push_back(share >= 0.5 ? std::uint8_t{0} : map_.wall[i]);
    }
    walls.map = std::make_shared<const CoverageMap>(std::move(map));
    return walls;
  }

 private:
  static WallRegion region(const std::string& name, RegionKind kind) {
    WallRegion r;
    r.name = name;
    r.kind = kind;
    return r;
  }
  Vec2 to_pixels(const Vec2& p) const {
    return p / map_.pixel + 0.5 * Vec2(map_.width, map_.height);
  }
  // Adds sign * share(x, y) to every pixel of the box `low` .. `high`, y up.
  template <typename Share>
  WallPainter& paint(const Vec2& low, const Vec2& high, double sign, std::uint8_t id,
                     Share&& share) {
    const auto at = [](double v, int size) {
      return static_cast<int>(std::clamp(v, 0.0, static_cast<double>(size)));
    };
    for (int y = at(low.y() - 4.0, map_.height); y < at(high.y() + 5.0, map_.height); ++y) {
      for (int x = at(low.x() - 4.0, map_.width); x < at(high.x() + 5.0, map_.width); ++x) {
        const auto i =
            static_cast<std::size_t>(map_.height - 1 - y) * static_cast<std::size_t>(map_.width) +
            static_cast<std::size_t>(x);
        const auto [part, within_3] = share(x, y);
        open_[i] += sign * part;
        if (sign < 0.0 && within_3) map_.wall[i] = id;
      }
    }
    return *this;
  }
  WallPainter& paint_polygon(const Polygon& metres, double sign, std::uint8_t id) {
    Polygon p;
    for (const Vec2& v : metres) p.push_back(to_pixels(v));
    Vec2 low = p[0], high = p[0];
    for (const Vec2& v : p) low = low.cwiseMin(v), high = high.cwiseMax(v);
    return paint(low, high, sign, id, [&](int x, int y) {
      const Vec2 c(x + 0.5, y + 0.5);
      double nearest = 1e9;
      bool inside = false;
      for (std::size_t i = 0; i < p.size(); ++i) {
        const Vec2 &a = p[i], &b = p[(i + 1) % p.size()];
        const double t = std::clamp((c - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
        nearest = std::min(nearest, (c - a - t * (b - a)).squaredNorm());
        if ((a.y() > c.y()) != (b.y() > c.y()) &&
            c.x() < a.x() + (c.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) {
          inside = !inside;
        }
      }
      const double part = nearest > 0.51 ? (inside ? 1.0 : 0.0) : polygon_in_square(p, x, y);
      return std::pair(part, inside || nearest < 9.0);
    });
  }
  WallPainter& paint_disc(const Vec2& metres, double radius, double sign, std::uint8_t id) {
    const Vec2 c = to_pixels(metres);
    const double r = radius / map_.pixel;
    return paint(c - Vec2(r, r), c + Vec2(r, r), sign, id, [&](int x, int y) {
      const double d = (Vec2(x + 0.5, y + 0.5) - c).norm() - r;
      const double part = std::abs(d) > 0.72 ? (d < 0.0 ? 1.0 : 0.0) : disc_in_square(c, r, x, y);
      return std::pair(part, d < 3.0);
    });
  }

  CoverageMap map_;
  std::vector<double> open_;
  std::vector<WallRegion> regions_;
};

// A straight wall of `thickness` [m] through the middle of an open map, along `angle`, `off` beside
// the map's centre.
inline Walls straight_wall(int size, double pixel, double thickness, double angle, double off) {
  const Vec2 n(-std::sin(angle), std::cos(angle));
  return WallPainter(size, size, pixel)
      .wall(rectangle(off * n, 4.0 * size * pixel, thickness, angle))
      .finish((off + thickness + 4.0 * pixel) * n);
}

}  // namespace handrail::paint
