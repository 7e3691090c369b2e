#include "server/scene/map_width.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace handrail {
namespace {

constexpr int kBlock = 8;          // pixels are looked at where their block is not all alike
constexpr int kApron = 2;          // around it
constexpr int kFar = 8;            // runs longer than this to one side do not end
constexpr double kNothing = 0.02;  // shares below do not count: rounding of the editor
constexpr double kWideAisle = 1.99, kThickWall = 0.99;  // two pixels and one, with rounding
constexpr int kAround = 3;  // half the square in which narrow pixels must be several

class Widths {
 public:
  explicit Widths(const CoverageMap& map) : map_(map) {}

  // Whether what the pixel is of (free space, or wall) is narrower there than `least` pixels.
  bool is_narrow(int x, int y, bool wall, double least) const {
    if (share(x, y, wall) < (wall ? kNothing : 0.5)) return false;
    const double row = run(x, y, 1, 0, wall), column = run(x, y, 0, 1, wall);
    // A strip that crosses rows at one angle and columns at the other; 0: does not end.
    const double inverse =
        (row > 0.0 ? 1.0 / (row * row) : 0.0) + (column > 0.0 ? 1.0 / (column * column) : 0.0);
    return inverse * least * least > 1.0;
  }

  // Whether the block and what is around it are all wall or all free.
  bool is_plain(int x0, int y0) const {
    const int x1 = std::min(map_.width, x0 + kBlock + kApron);
    const int y1 = std::min(map_.height, y0 + kBlock + kApron);
    const int left = std::max(0, x0 - kApron);
    std::uint16_t least = 65535, most = 0;
    for (int y = std::max(0, y0 - kApron); y < y1; ++y) {
      const std::uint16_t* row = map_.open.data() + std::ptrdiff_t{y} * map_.width;
      for (int x = left; x < x1; ++x) {
        least = std::min(least, row[x]);
        most = std::max(most, row[x]);
      }
    }
    return least == most;
  }

 private:
  // Outside the map is wall, but not a thin one.
  double share(int x, int y, bool wall) const {
    if (x < 0 || y < 0 || x >= map_.width || y >= map_.height) return wall ? 1.0 : 0.0;
    const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(map_.width) +
                   static_cast<std::size_t>(x);
    const double open = map_.open[i] / 65535.0;
    return wall ? 1.0 - open : open;
  }
  // Length of the run through the pixel; 0: longer than kFar to a side.
  double run(int x, int y, int dx, int dy, bool wall) const {
    double length = share(x, y, wall);
    for (const int side : {-1, 1}) {
      for (int k = 1;; ++k) {
        if (k > kFar) return 0.0;
        const double s = share(x + side * k * dx, y + side * k * dy, wall);
        if (s < kNothing) break;
        length += s;
      }
    }
    return length;
  }

  const CoverageMap& map_;
};

// The pixels that have at least `several` like them around: a sharp corner has fewer.
Narrows::Found keep_several(const CoverageMap& map, const std::vector<std::size_t>& narrow,
                            int several) {
  Narrows::Found out;
  if (narrow.empty()) return out;
  std::vector<bool> marked(map.open.size(), false);
  for (const std::size_t i : narrow) marked[i] = true;
  const auto width = static_cast<std::size_t>(map.width);
  for (const std::size_t i : narrow) {
    const int x = static_cast<int>(i % width), y = static_cast<int>(i / width);
    int count = 0;
    for (int v = std::max(0, y - kAround); v <= std::min(map.height - 1, y + kAround); ++v) {
      for (int u = std::max(0, x - kAround); u <= std::min(map.width - 1, x + kAround); ++u) {
        count += marked[static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u)] ? 1 : 0;
      }
    }
    if (count < several) continue;
    if (out.count++ == 0) out.first = i;
  }
  return out;
}

}  // namespace

Narrows narrows_of(const CoverageMap& map) {
  const Widths widths(map);
  std::vector<std::size_t> aisles, walls;
  for (int y0 = 0; y0 < map.height; y0 += kBlock) {
    for (int x0 = 0; x0 < map.width; x0 += kBlock) {
      if (widths.is_plain(x0, y0)) continue;
      for (int y = y0; y < std::min(map.height, y0 + kBlock); ++y) {
        for (int x = x0; x < std::min(map.width, x0 + kBlock); ++x) {
          const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width) +
                         static_cast<std::size_t>(x);
          if (widths.is_narrow(x, y, false, kWideAisle)) aisles.push_back(i);
          if (widths.is_narrow(x, y, true, kThickWall)) walls.push_back(i);
        }
      }
    }
  }
  constexpr int kSeveral = 6;
  return {keep_several(map, aisles, kSeveral), keep_several(map, walls, kSeveral)};
}

}  // namespace handrail
