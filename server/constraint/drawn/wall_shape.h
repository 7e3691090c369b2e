// Drawn pieces of free space: how far a point is from one, and its border. Map frame, SI.
#pragma once

#include <vector>

#include "server/constraint/drawn/outline_piece.h"
#include "server/model/walls.h"

namespace handrail {

// How far `x` is outside `shape`: negative inside, 0 on its border [m]. Past a corner and near
// an arc's flat ends it may be too small in size, never wrong in sign.
double outside_by(const WallShape& shape, const Vec2& x) noexcept;

// The shape's border as closed loops, free space on the left. May allocate.
std::vector<OutlinePiece> border_of(const WallShape& shape);

}  // namespace handrail
