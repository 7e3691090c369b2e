#include "server/painting/wall_near.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace handrail {
namespace {

constexpr int kSteps = 3;

struct Given {
  std::size_t pixel;
  std::uint8_t wall;
};

// The wall of the first of the 8 neighbours that has one, straight ones first.
std::uint8_t wall_beside(const CoverageMap& map, std::size_t i) {
  static constexpr int kNeighbours[8][2] = {{0, -1},  {-1, 0}, {1, 0},  {0, 1},
                                            {-1, -1}, {1, -1}, {-1, 1}, {1, 1}};
  const auto width = static_cast<std::size_t>(map.width);
  const int x = static_cast<int>(i % width), y = static_cast<int>(i / width);
  for (const auto& step : kNeighbours) {
    const int u = x + step[0], v = y + step[1];
    if (u < 0 || v < 0 || u >= map.width || v >= map.height) continue;
    const std::uint8_t wall =
        map.wall[static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u)];
    if (wall != kNoWall) return wall;
  }
  return kNoWall;
}

}  // namespace

void spread_walls(std::uint8_t other, CoverageMap& map) {
  const bool one = std::all_of(map.wall.begin(), map.wall.end(),
                               [&](std::uint8_t wall) { return wall == kNoWall || wall == other; });
  // Each step gives to all at once, so that no side is favoured.
  for (int step = 0; !one && step < kSteps; ++step) {
    std::vector<Given> given;
    for (std::size_t i = 0; i < map.wall.size(); ++i) {
      if (map.wall[i] != kNoWall) continue;
      const std::uint8_t wall = wall_beside(map, i);
      if (wall != kNoWall) given.push_back({i, wall});
    }
    for (const Given& g : given) map.wall[g.pixel] = g.wall;
  }
  std::replace(map.wall.begin(), map.wall.end(), kNoWall, other);
}

}  // namespace handrail
