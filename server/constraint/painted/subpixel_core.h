// The middle of thin painted walls: what makes them stand where their faces cannot be told apart.
#pragma once

#include <cstdint>
#include <unordered_set>
#include <vector>

#include "server/constraint/painted/subpixel_patch.h"

namespace handrail {

// A wall is at least this thick about its core, and a core is looked for this far around [pixels].
inline constexpr double kCoreRadius = 0.3;
inline constexpr double kCoreReach = 1.0;

// Two adjacent pixels that are mostly wall, each at the centroid of the wall around it: on the
// middle line of a wall one pixel thin, well inside a thicker one. Pixels from the map's corner.
struct CoreSegment {
  Vec2 a = Vec2::Zero(), b = Vec2::Zero();
  // From the core's skin, negative inside.
  double distance(const Vec2& p) const noexcept;
};

// Some pixels of a map.
class PixelSet {
 public:
  void add(int x, int y) { keys_.insert(key(x, y)); }
  bool has(int x, int y) const { return keys_.count(key(x, y)) != 0; }

 private:
  static std::int64_t key(int x, int y) { return std::int64_t{y} * (std::int64_t{1} << 32) + x; }
  std::unordered_set<std::int64_t> keys_;
};

// Appends the cores of walls around the 8 x 8 pixels from (x, y), and a pixel beyond; none where
// all around is wall, and none in pixels `explained` by surfaces known to be right.
void find_cores(const CoverageView& view, const PixelSet& explained, int x, int y,
                std::vector<CoreSegment>& out);

}  // namespace handrail
