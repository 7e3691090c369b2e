// Steps of building an outline. May allocate.
#pragma once

#include <vector>

#include "server/constraint/drawn/outline_piece.h"
#include "server/model/walls.h"

namespace handrail {

// Shortest piece kept [m]: ends nearer to each other are one point.
inline constexpr double kShortestPiece = 4.0 * kBorderTolerance;

// The border of the union, in no order; ends that belong together coincide exactly.
std::vector<OutlinePiece> border_of_union(const std::vector<WallShape>& shapes);

// The border with pieces of one line or circle that follow each other made one, arcs then cut
// evenly into pieces of at most 120 degrees: how shapes were cut leaves no trace. A whole circle
// stays.
std::vector<OutlinePiece> merged(const std::vector<OutlinePiece>& pieces);

// For each piece the one that follows it around free space.
std::vector<int> chain(const std::vector<OutlinePiece>& pieces);

// The chained pieces with every wall corner that protrudes into free space rounded by `radius` or
// by the largest radius that fits; corners where two borders touch are left.
std::vector<OutlinePiece> with_fillets(const std::vector<OutlinePiece>& pieces, double radius);

}  // namespace handrail
