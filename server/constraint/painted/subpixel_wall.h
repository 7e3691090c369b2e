// The proxy on the anti-aliased boundary of a painted map.
#pragma once

#include <memory>

#include "server/constraint/wall_proxy.h"

namespace handrail {

// The surface is where the distance of SubpixelField is zero. In free space the proxy goes straight
// to the hand, in steps that no wall of one pixel fits in. On a wall it goes along the surface to
// the foot of the hand on the circle that fits the surface where it is, and is put back on the
// surface there; again until the hand is straight behind it. Every step comes nearer to the hand.
//
// A hand that starts inside a wall: the proxy starts at the nearest free point within 50 pixels,
// else at the scene's start. Where a wall that vanishes adjoins one that stays, the seam between
// them is as fine as the pixels. One field is built per different set of vanished walls among the
// stages; set_gone to a set of no stage changes nothing.
//
// Needs walls.map. Throws std::invalid_argument without one.
std::unique_ptr<WallProxy> make_subpixel_proxy(const Walls& walls);

}  // namespace handrail
