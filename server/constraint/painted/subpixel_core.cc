#include "server/constraint/painted/subpixel_core.h"

#include <algorithm>
#include <array>

namespace handrail {
namespace {

// In brackets: the range in which the tests hold, see WALLS.md. Else derived.
constexpr double kCore = 0.45;  // [0.45, 0.562] so much a wall one pixel thin fills of some pixel
// Around the tile: a pixel whose core reaches in, and the next, which it is joined to.
constexpr int kMargin = 2;
constexpr int kAcross = 8 + 2 * kMargin;

struct CorePixel {
  bool core = false;
  bool deep = false;  // all wall around
  Vec2 at = Vec2::Zero();
};

CorePixel pixel_at(const CoverageView& view, const PixelSet& explained, int x, int y) {
  CorePixel out;
  out.core = view.wall(x, y) >= kCore && !explained.has(x, y);
  if (!out.core) return out;
  double sum = 0.0;
  Vec2 moment = Vec2::Zero();
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const double w = view.wall(x + dx, y + dy);
      sum += w;
      moment += w * Vec2(dx, dy);
    }
  }
  out.deep = sum == 9.0;
  out.at = Vec2(x + 0.5, y + 0.5) + moment / sum;
  return out;
}

}  // namespace

double CoreSegment::distance(const Vec2& p) const noexcept {
  const Vec2 d = b - a;
  const double length2 = d.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((p - a).dot(d) / length2, 0.0, 1.0) : 0.0;
  return (p - a - t * d).norm() - kCoreRadius;
}

void find_cores(const CoverageView& view, const PixelSet& explained, int x, int y,
                std::vector<CoreSegment>& out) {
  std::array<std::array<CorePixel, kAcross>, kAcross> pixels;  // [x][y]
  for (int i = 0; i < kAcross; ++i) {
    for (int j = 0; j < kAcross; ++j) {
      pixels[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] =
          pixel_at(view, explained, x - kMargin + i, y - kMargin + j);
    }
  }
  const auto join = [&](const CorePixel& a, const CorePixel& b) {
    if (a.core && b.core && !(a.deep && b.deep)) out.push_back({a.at, b.at});
  };
  for (std::size_t i = 0; i + 1 < kAcross; ++i) {
    for (std::size_t j = 0; j + 1 < kAcross; ++j) {
      const CorePixel &here = pixels[i][j], &right = pixels[i + 1][j], &above = pixels[i][j + 1],
                      &beyond = pixels[i + 1][j + 1];
      join(here, right);
      join(here, above);
      // Across a corner only where nothing else leads there: an inner corner is not filled.
      if (!right.core && !above.core) join(here, beyond);
      if (!here.core && !beyond.core) join(right, above);
    }
  }
}

}  // namespace handrail
