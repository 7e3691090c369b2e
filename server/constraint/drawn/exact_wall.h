// The proxy on drawn shapes, exactly.
#pragma once

#include <memory>

#include "server/constraint/wall_proxy.h"

namespace handrail {

// The proxy runs straight toward the hand until it meets the border of free space, then along its
// segments and arcs as long as the hand comes nearer, around corners and off again where the way is
// free. It is done where no way within free space leads nearer: at a local minimum of distance. It
// goes piece by piece, so the hand's speed costs accuracy nothing; kMaxLegs pieces a tick, and
// what 2048 looks at pieces allow, then it carries on next tick. A hand that starts up to kNearBy
// inside the wall is put to the nearest point of the border, deeper in to the scene's start. While
// `outside` is gone everything is free and the proxy is the hand; where no shape is, its region is
// then `outside`.
//
// Exact to rounding, but for borders nearer to each other than kBorderTolerance (outline_piece.h),
// which count as one.
inline constexpr double kNearBy = 5e-3;  // [m]
inline constexpr int kMaxLegs = 64;

// `walls` must outlive the proxy. Throws std::invalid_argument without shapes.
std::unique_ptr<WallProxy> make_exact_proxy(const Walls& walls);

}  // namespace handrail
