// Which drawn shapes the hand can get to.
#pragma once

#include <vector>

#include "server/model/walls.h"

namespace handrail {

// True for a point in the shape or within 1 nm of it.
bool is_inside(const WallShape& shape, const Vec2& p) noexcept;

// For each shape, whether a chain of shapes that overlap or share a border leads to it from one
// that holds `start`. Sampled at half the narrower shape's width: two shapes that meet over less
// count as apart.
std::vector<bool> shapes_reached(const std::vector<WallShape>& shapes, const Vec2& start);

}  // namespace handrail
