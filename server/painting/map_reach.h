// Which free pixels of a painted map hang together.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "server/model/walls.h"

namespace handrail {

// The pixel that holds a point of the map's frame; empty outside the map.
std::optional<std::size_t> pixel_of(const CoverageMap& map, const Vec2& p) noexcept;
// The pixel's centre, map frame [m].
Vec2 centre_of(const CoverageMap& map, std::size_t pixel) noexcept;

// At least half of the pixel is free, with the wall regions in `gone` (bit = region) away.
inline bool is_open(const CoverageMap& map, std::size_t pixel, std::uint64_t gone) noexcept {
  return map.open[pixel] >= 32768 || (gone >> map.wall[pixel] & 1) != 0;
}

// Counts in pixels.
struct Reach {
  std::size_t open = 0;       // free
  std::size_t reached = 0;    // of these, connected to the start by shared sides
  std::size_t unreached = 0;  // in pieces of more than a few pixels
  std::size_t first_unreached = 0;
  std::array<std::size_t, 64> region_open{}, region_reached{};
};
Reach reach_of(const CoverageMap& map, std::size_t start, std::uint64_t gone);

}  // namespace handrail
