// Which wall is felt where.
#pragma once

#include <cstdint>

#include "server/model/walls.h"

namespace handrail {

inline constexpr std::uint8_t kNoWall = 255;  // in CoverageMap::wall before spread_walls

// Gives pixels without a wall the wall of the nearest pixel that has one, up to 3 steps (of 8
// directions) away, and `other` beyond.
void spread_walls(std::uint8_t other, CoverageMap& map);

}  // namespace handrail
