#include "server/painting/coverage_check.h"

#include <cmath>
#include <cstdint>

#include "server/base/plain_text.h"
#include "server/base/units.h"
#include "server/painting/map_reach.h"
#include "server/painting/map_width.h"

namespace handrail {
namespace {

constexpr double kLeastShare = 0.01;  // of free space that the start must reach

constexpr double kFirm = 0.75;  // thinner walls let slow hands pass, too [pixels]

// Adding 0 makes -0 a 0.
double rounded(double value, double unit) { return std::round(value / unit * 100.0) / 100.0 + 0.0; }

std::string place_text(const CoverageMap& map, std::size_t i) {
  const auto w = static_cast<std::size_t>(map.width);
  const Vec2 p = centre_of(map, i);
  return "pixel (" + std::to_string(i % w) + ", " + std::to_string(i / w) + "), " +
         number_text(rounded(p.x(), kMm)) + ", " + number_text(rounded(p.y(), kMm)) + " mm";
}

std::string start_problem(const Walls& walls, std::size_t& pixel) {
  const CoverageMap& map = *walls.map;
  const std::string start = "the start " + number_text(rounded(walls.start.x(), kMm)) + ", " +
                            number_text(rounded(walls.start.y(), kMm)) + " mm";
  const std::optional<std::size_t> at = pixel_of(map, walls.start);
  if (!at) return start + " is outside the map";
  pixel = *at;
  if (is_open(map, *at, gone_of(walls.stages.front()))) return {};
  const std::string& wall = walls.regions[map.wall[*at]].name;
  return start + " is inside the wall '" + wall + "', pixel (" +
         std::to_string(*at % static_cast<std::size_t>(map.width)) + ", " +
         std::to_string(*at / static_cast<std::size_t>(map.width)) + ")";
}

// What the hand can get to while the walls that any stage takes away are away.
std::string reach_problem(const Walls& walls, std::size_t start, std::string& warning) {
  const CoverageMap& map = *walls.map;
  std::uint64_t gone = 0;
  for (const WallStage& stage : walls.stages) gone |= gone_of(stage);
  const Reach reach = reach_of(map, start, gone);
  const double mm2 = map.pixel * map.pixel / (kMm * kMm);
  const auto area = [&](std::size_t pixels) {
    return number_text(std::round(static_cast<double>(pixels) * mm2 * 100.0) / 100.0) + " mm^2";
  };
  std::string sealed = "the wall seals the start off: it reaches " + area(reach.reached) + " of " +
                       area(reach.open) + " of free space";
  for (std::size_t r = 0; r < walls.regions.size(); ++r) {
    if (walls.regions[r].kind != RegionKind::kAisle) continue;
    if (reach.region_open[r] == 0 || reach.region_reached[r] > 0) continue;
    return sealed + " and nothing of aisle '" + walls.regions[r].name + "'";
  }
  if (static_cast<double>(reach.reached) < kLeastShare * static_cast<double>(reach.open)) {
    return sealed;
  }
  if (reach.unreached > 0) {
    warning = area(reach.open - reach.reached) +
              " of free space cannot be reached from the start, " + "first at " +
              place_text(map, reach.first_unreached);
  }
  return {};
}

}  // namespace

MapCheck check_map(const Walls& walls) {
  MapCheck out;
  std::size_t start = 0;
  out.problem = start_problem(walls, start);
  if (!out.problem.empty()) return out;
  std::string warning;
  out.problem = reach_problem(walls, start, warning);
  if (!out.problem.empty()) return out;
  if (!warning.empty()) out.warnings.push_back(warning);
  const Narrows narrows = narrows_of(*walls.map);
  const auto there = [&](const Narrows::Found& found) {
    return " at " + place_text(*walls.map, found.at) + ": it measures " +
           number_text(rounded(found.width, 1.0)) + " pixels (" +
           number_text(rounded(found.width * walls.map->pixel, kMm)) + " mm) there, ";
  };
  if (narrows.aisles.count > 0) {
    out.warnings.push_back("an aisle is narrower than two pixels" + there(narrows.aisles) +
                           "its walls will not be felt where they were drawn");
  }
  if (narrows.slits.count > 0 && !narrows.slits.open) {
    out.warnings.push_back("an aisle is narrower than one pixel" + there(narrows.slits) +
                           "nothing of it is left open");
  }
  if (narrows.walls.count > 0) {
    out.warnings.push_back("a wall is thinner than one pixel" + there(narrows.walls) +
                           (narrows.walls.width < kFirm ? "a fast hand may pass it, and a slow one"
                                                        : "a fast hand may pass it"));
  }
  return out;
}

}  // namespace handrail
