// Which palette colours stand around a pixel, while a map is read.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "server/model/walls.h"

namespace handrail {

inline constexpr std::uint8_t kMixed = 0x80;  // in a region: the pixel is no palette colour

struct NearColours {
  std::array<int, 64> entries;  // rising
  int count = 0;
};

// The entries of the pixels that are no mixtures, in the square that reaches `reach` pixels to each
// side.
NearColours near_colours(const CoverageMap& map, std::size_t pixel, int reach) noexcept;

}  // namespace handrail
