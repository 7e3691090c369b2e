#include "server/painting/map_reach.h"

#include <cmath>
#include <utility>
#include <vector>

#include "server/painting/map_fill.h"

namespace handrail {
namespace {

constexpr std::size_t kSpeck = 16;  // smaller free pieces are not worth a warning [pixels]

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
  const std::size_t row = pixel / width, column = pixel % width;
  const double x = static_cast<double>(column) + 0.5 - 0.5 * map.width;
  const double y = 0.5 * map.height - static_cast<double>(row) - 0.5;
  return Vec2(x, y) * map.pixel;
}

Reach reach_of(const CoverageMap& map, std::size_t start, std::uint64_t gone) {
  Reach out;
  std::vector<std::uint8_t> free(map.open.size());
  for (std::size_t i = 0; i < free.size(); ++i) free[i] = is_open(map, i, gone) ? 1 : 0;
  MapFiller filler(map, std::move(free));
  for (std::size_t i = 0; i < map.open.size(); ++i) {
    if (!filler.has(i)) continue;
    ++out.open;
    ++out.region_open[map.region[i]];
  }
  filler.take(start, [&](std::size_t first, std::size_t end) {
    out.reached += end - first;
    for (std::size_t k = first; k < end; ++k) ++out.region_reached[map.region[k]];
  });
  for (std::size_t i = 0; i < map.open.size(); ++i) {
    if (!filler.has(i)) continue;
    std::size_t size = 0;
    filler.take(i, [&](std::size_t first, std::size_t end) { size += end - first; });
    if (size <= kSpeck) continue;
    if (out.unreached == 0) out.first_unreached = i;
    out.unreached += size;
  }
  return out;
}

}  // namespace handrail
