#include "server/scene/map_reach.h"

#include <cmath>
#include <vector>

namespace handrail {
namespace {

constexpr std::size_t kSpeck = 16;  // smaller free pieces are not worth a warning [pixels]

// Fills connected pieces of free space row by row.
class Filler {
 public:
  Filler(const CoverageMap& map, std::uint64_t gone)
      : map_(map), width_(static_cast<std::size_t>(map.width)), free_(map.open.size()) {
    for (std::size_t i = 0; i < free_.size(); ++i) free_[i] = is_open(map, i, gone) ? 1 : 0;
  }
  bool is_free(std::size_t i) const { return free_[i] != 0; }

  // Takes the piece around `start` away; calls `run(first, end)` for each of its runs.
  template <typename Run>
  void take(std::size_t start, const Run& run) {
    waiting_.assign(1, start);
    while (!waiting_.empty()) {
      const std::size_t i = waiting_.back();
      waiting_.pop_back();
      if (free_[i] == 0) continue;
      const std::size_t row = i / width_ * width_;
      std::size_t first = i, end = i + 1;
      while (first > row && free_[first - 1] != 0) --first;
      while (end < row + width_ && free_[end] != 0) ++end;
      for (std::size_t k = first; k < end; ++k) free_[k] = 0;
      run(first, end);
      if (row > 0) wait_for(first - width_, end - width_);
      if (row + width_ < free_.size()) wait_for(first + width_, end + width_);
    }
  }

 private:
  // One pixel of each free run that begins in a stretch or reaches into it.
  void wait_for(std::size_t first, std::size_t end) {
    for (std::size_t k = first; k < end; ++k) {
      if (free_[k] != 0 && (k == first || free_[k - 1] == 0)) waiting_.push_back(k);
    }
  }

  const CoverageMap& map_;
  std::size_t width_;
  std::vector<std::uint8_t> free_;
  std::vector<std::size_t> waiting_;
};

}  // namespace

std::optional<std::size_t> pixel_of(const CoverageMap& map, const Vec2& p) noexcept {
  const double x = std::floor(p.x() / map.pixel + 0.5 * map.width);
  const double y = std::floor(0.5 * map.height - p.y() / map.pixel);
  if (!(x >= 0.0 && y >= 0.0 && x < map.width && y < map.height)) return std::nullopt;
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width) +
         static_cast<std::size_t>(x);
}

Vec2 centre_of(const CoverageMap& map, std::size_t pixel) noexcept {
  const auto width = static_cast<std::size_t>(map.width);
  const double x = static_cast<double>(pixel % width) + 0.5 - 0.5 * map.width;
  const double y = 0.5 * map.height - static_cast<double>(pixel / width) - 0.5;
  return Vec2(x, y) * map.pixel;
}

Reach reach_of(const CoverageMap& map, std::size_t start, std::uint64_t gone) {
  Reach out;
  Filler filler(map, gone);
  for (std::size_t i = 0; i < map.open.size(); ++i) {
    if (!filler.is_free(i)) continue;
    ++out.open;
    ++out.region_open[map.region[i]];
  }
  filler.take(start, [&](std::size_t first, std::size_t end) {
    out.reached += end - first;
    for (std::size_t k = first; k < end; ++k) ++out.region_reached[map.region[k]];
  });
  for (std::size_t i = 0; i < map.open.size(); ++i) {
    if (!filler.is_free(i)) continue;
    std::size_t size = 0;
    filler.take(i, [&](std::size_t first, std::size_t end) { size += end - first; });
    if (size <= kSpeck) continue;
    if (out.unreached == 0) out.first_unreached = i;
    out.unreached += size;
  }
  return out;
}

}  // namespace handrail
