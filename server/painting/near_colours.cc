#include "server/painting/near_colours.h"

#include <algorithm>

namespace handrail {

NearColours near_colours(const CoverageMap& map, std::size_t pixel, int reach) noexcept {
  const int w = map.width, x = static_cast<int>(pixel % static_cast<std::size_t>(w)),
            y = static_cast<int>(pixel / static_cast<std::size_t>(w));
  std::uint64_t present = 0;
  for (int v = std::max(0, y - reach); v <= std::min(map.height - 1, y + reach); ++v) {
    const std::uint8_t* row = map.region.data() + std::ptrdiff_t{v} * w;
    for (int u = std::max(0, x - reach); u <= std::min(w - 1, x + reach); ++u) {
      if ((row[u] & kMixed) == 0) present |= std::uint64_t{1} << row[u];
    }
  }
  NearColours out;
  for (; present != 0; present &= present - 1) {
    out.entries[static_cast<std::size_t>(out.count++)] = __builtin_ctzll(present);
  }
  return out;
}

}  // namespace handrail
