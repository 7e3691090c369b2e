// The surface of a painted wall, column by column, from the coverage of its pixels.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "server/model/walls.h"

namespace handrail {

// A pixel this much wall is all wall: above 254/255, so that a step of 8 bits counts.
inline constexpr double kFull = 0.997;

// Pixels of a map as the builder sees them: how much of each is wall, Y up from the lower left
// corner; outside the map all is wall. Walls of regions in `gone` (bit = region) are free.
class CoverageView {
 public:
  CoverageView(const CoverageMap& map, std::uint64_t gone) : map_(map), gone_(gone) {}

  int width() const noexcept { return map_.width; }
  int height() const noexcept { return map_.height; }
  // 0 free to 1 wall.
  double wall(int x, int y) const noexcept {
    if (x < 0 || y < 0 || x >= map_.width || y >= map_.height) return 1.0;
    const std::size_t i = index(x, y);
    if (gone_ != 0 && (gone_ >> (map_.wall[i] & 63) & 1) != 0) return 0.0;
    return 1.0 - map_.open[i] * (1.0 / 65535.0);
  }

 private:
  std::size_t index(int x, int y) const noexcept {
    return static_cast<std::size_t>(map_.height - 1 - y) * static_cast<std::size_t>(map_.width) +
           static_cast<std::size_t>(x);
  }

  const CoverageMap& map_;
  std::uint64_t gone_;
};

// A piece of surface, one pixel wide: v = height + slope u + bend u^2 for u from `from` to `to`,
// from the middle of its column. u is X and v is Y; `across`: the other way round. Pixels
// throughout.
struct SurfacePatch {
  double middle = 0.0;  // u of the column's middle
  double height = 0.0;
  double slope = 0.0;
  double bend = 0.0;
  double from = -0.5, to = 0.5;
  double side = 1.0;  // +1: free space toward greater v, -1: toward less
  bool across = false;
  bool delicate = false;  // a thin wall, a narrow gap, a tight curve or an end: sampled finely
  // What is past the ends: 0 as the tangent there says, +1 free space, -1 wall.
  std::int8_t past_from = 0, past_to = 0;

  // A sample at (x, y) against this piece.
  struct Distance {
    double value;  // to the piece, positive on its free side
    double rank;   // the piece with the least speaks for the sample
    double bend;   // of the distance there: its Laplacian [1/pixel]
  };
  Distance distance(double x, double y) const noexcept;
  // The point of the surface at u.
  Vec2 at(double u) const noexcept {
    const double v = height + (slope + bend * u) * u;
    return across ? Vec2(v, middle + u) : Vec2(middle + u, v);
  }
  // Along the surface toward greater u, not unit.
  Vec2 along(double u) const noexcept {
    const double rise = slope + 2.0 * bend * u;
    return across ? Vec2(rise, 1.0) : Vec2(1.0, rise);
  }
  // Out of the wall, unit.
  Vec2 normal(double u) const noexcept {
    const double rise = slope + 2.0 * bend * u;
    const double stretch = side / std::sqrt(1.0 + rise * rise);
    return across ? Vec2(stretch, -rise * stretch) : Vec2(-rise * stretch, stretch);
  }
};

// Where a smooth surface ends, bends away or meets another: its last smooth piece, and the way to
// its end.
struct SurfaceEnd {
  SurfacePatch piece;
  double way = 1.0;    // +1: the end is toward greater u
  bool rough = false;  // through three columns or two, else through five
};

// Appends the pieces whose middle is in the 8 x 8 pixels from (x, y). A column's height is the sum
// of its coverage from free to wall, exact for straight edges; heights of three columns give slope
// and bend. Where a wall or gap is so thin that no pixel of the column is all wall or all free, its
// two faces are half the column's sum to either side of its centroid.
void find_patches(const CoverageView& view, int x, int y, std::vector<SurfacePatch>& out,
                  std::vector<SurfaceEnd>& ends);

}  // namespace handrail
