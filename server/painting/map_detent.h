// Detents that a painted map's colours ask for.
#pragma once

#include <optional>
#include <vector>

#include "server/model/effect_list.h"
#include "server/model/field_problem.h"
#include "server/model/walls.h"

namespace handrail {

// A connected patch of one region's pixels.
struct MapPatch {
  std::size_t pixels = 0;      // that are mostly of the region
  Vec2 centre = Vec2::Zero();  // their centroid, map frame [m]
};

// All of a region, from the top down. Pixels hang together by shared sides.
std::vector<MapPatch> patches_of(const CoverageMap& map, std::uint8_t region);

// Adds a place to the detent in `effects` for every patch of the regions that have a detent. A
// problem, with the path of the region: more than kMostDetents places in all, reaches that overlap,
// a patch so small or large that no detent has its radius. Warns where the scene lists no detent,
// and of a place in a wall.
std::optional<FieldProblem> paint_detents(Walls& walls, std::vector<EffectSpec>& effects);

}  // namespace handrail
