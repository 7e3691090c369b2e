#include "server/painting/map_width.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace handrail {
namespace {

constexpr int kBlock = 8;  // pixels are looked at where their block is not all alike
constexpr int kApron = 2;  // around it
// Runs longer than this to one side do not end. A strip below kNoPixelFull crosses rows or columns
// in sqrt(2) times its width, 3.2 pixels, at most.
constexpr int kFar = 8;
constexpr double kNothing = 0.02;  // shares below do not count: rounding of the editor
constexpr double kWideAisle = 1.99, kThickWall = 0.99;  // two pixels and one, with rounding
constexpr int kAround = 3, kSeveral = 6;  // half the square in which narrow pixels must be so many
// The widest strip that may hold no pixel as a whole: at 45 deg a pixel is sqrt(2) across and the
// next is 1 / sqrt(2) further on, 2.12 together; with rounding.
constexpr double kNoPixelFull = 2.2;
constexpr double kEndless = 1e9;
constexpr std::uint16_t kHalf = 32768;  // of CoverageMap::open

// What the pixel has of wall, or of free space. Outside the map is wall, but not a thin one.
double share_of(const CoverageMap& map, int x, int y, bool wall) {
  if (x < 0 || y < 0 || x >= map.width || y >= map.height) return wall ? 1.0 : 0.0;
  const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width) +
                 static_cast<std::size_t>(x);
  const double open = map.open[i] / 65535.0;
  return wall ? 1.0 - open : open;
}

// Length of the run through the pixel; 0: longer than kFar to a side.
double run_of(const CoverageMap& map, int x, int y, int dx, int dy, bool wall) {
  double length = share_of(map, x, y, wall);
  for (const int side : {-1, 1}) {
    for (int k = 1;; ++k) {
      if (k > kFar) return 0.0;
      const double s = share_of(map, x + side * k * dx, y + side * k * dy, wall);
      if (s < kNothing) break;
      length += s;
    }
  }
  return length;
}

double width_at(const CoverageMap& map, int x, int y, bool wall) {
  if (share_of(map, x, y, wall) < kNothing) return kEndless;
  const double row = run_of(map, x, y, 1, 0, wall), column = run_of(map, x, y, 0, 1, wall);
  // A strip that crosses rows at one angle and columns at the other; 0: does not end.
  const double inverse =
      (row > 0.0 ? 1.0 / (row * row) : 0.0) + (column > 0.0 ? 1.0 / (column * column) : 0.0);
  return inverse > 0.0 ? 1.0 / std::sqrt(inverse) : kEndless;
}

// Whether the block from (x0, y0) and what is around it are all wall or all free.
bool is_plain(const CoverageMap& map, int x0, int y0) {
  const int x1 = std::min(map.width, x0 + kBlock + kApron);
  const int y1 = std::min(map.height, y0 + kBlock + kApron);
  const int left = std::max(0, x0 - kApron);
  std::uint16_t least = 65535, most = 0;
  for (int y = std::max(0, y0 - kApron); y < y1; ++y) {
    const std::uint16_t* row = map.open.data() + std::ptrdiff_t{y} * map.width;
    for (int x = left; x < x1; ++x) {
      least = std::min(least, row[x]);
      most = std::max(most, row[x]);
    }
  }
  return least == most;
}

// Calls `visit(pixel)` for one and those around it, for as long as it returns true.
template <typename Visit>
void look_around(const CoverageMap& map, std::size_t pixel, int reach, const Visit& visit) {
  const auto width = static_cast<std::size_t>(map.width);
  const int x = static_cast<int>(pixel % width), y = static_cast<int>(pixel / width);
  for (int v = std::max(0, y - reach); v <= std::min(map.height - 1, y + reach); ++v) {
    for (int u = std::max(0, x - reach); u <= std::min(map.width - 1, x + reach); ++u) {
      if (!visit(static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u))) return;
    }
  }
}

// Pixels narrower than some width, with it.
struct Marked {
  static constexpr double kUnit = 0.01;  // [pixels]
  std::vector<std::size_t> pixels;
  std::vector<std::uint8_t> width;  // of each pixel of the map, 0: wide; empty: all are

  void add(const CoverageMap& map, std::size_t i, double w) {
    width.resize(map.open.size());
    width[i] = static_cast<std::uint8_t>(1 + std::lround(w / kUnit));
    pixels.push_back(i);
  }
};

// The pixels that have several like them around: a sharp corner has fewer.
Narrows::Found keep_several(const CoverageMap& map, const Marked& marked) {
  Narrows::Found out;
  for (const std::size_t i : marked.pixels) {
    std::array<std::uint8_t, (2 * kAround + 1) * (2 * kAround + 1)> width;
    int count = 0;
    bool open = false;
    look_around(map, i, kAround, [&](std::size_t k) {
      if (marked.width[k] == 0) return true;
      width[static_cast<std::size_t>(count++)] = marked.width[k];
      open = open || map.open[k] >= kHalf;
      return true;
    });
    if (count < kSeveral) continue;
    // The ends of a strip are pixels that it only fills in part.
    const auto middle = width.begin() + count / 2;
    std::nth_element(width.begin(), middle, width.begin() + count);
    const double median = (*middle - 1) * Marked::kUnit;
    if (out.count++ == 0 || median < out.width) {
      out.at = i;
      out.width = median;
      out.open = open;
    }
  }
  return out;
}

}  // namespace

double strip_width(const CoverageMap& map, std::size_t pixel, bool wall) noexcept {
  const auto width = static_cast<std::size_t>(map.width);
  return width_at(map, static_cast<int>(pixel % width), static_cast<int>(pixel / width), wall);
}

bool is_in_thin_strip(const CoverageMap& map, std::size_t pixel, bool wall) noexcept {
  // Thin pixels that hang together, from this one on: where strips cross it is not thin itself.
  std::array<std::size_t, kSeveral> found{};
  std::size_t count = 0;
  const auto look = [&](std::size_t k) {
    const auto end = found.begin() + static_cast<std::ptrdiff_t>(count);
    if (std::find(found.begin(), end, k) == end && strip_width(map, k, wall) < kNoPixelFull) {
      found[count++] = k;
    }
    return count < kSeveral;
  };
  look_around(map, pixel, 1, look);
  for (std::size_t i = 0; i < count && count < kSeveral; ++i) {
    look_around(map, found[i], 1, look);
  }
  return count == kSeveral;
}

Narrows narrows_of(const CoverageMap& map) {
  Marked aisles, slits, walls;
  for (int y0 = 0; y0 < map.height; y0 += kBlock) {
    for (int x0 = 0; x0 < map.width; x0 += kBlock) {
      if (is_plain(map, x0, y0)) continue;
      for (int y = y0; y < std::min(map.height, y0 + kBlock); ++y) {
        for (int x = x0; x < std::min(map.width, x0 + kBlock); ++x) {
          const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width) +
                         static_cast<std::size_t>(x);
          const double aisle = width_at(map, x, y, false), wall = width_at(map, x, y, true);
          if (aisle < kWideAisle && map.open[i] >= kHalf) aisles.add(map, i, aisle);
          if (aisle < kThickWall) slits.add(map, i, aisle);
          if (wall < kThickWall) walls.add(map, i, wall);
        }
      }
    }
  }
  return {keep_several(map, aisles), keep_several(map, slits), keep_several(map, walls)};
}

}  // namespace handrail
