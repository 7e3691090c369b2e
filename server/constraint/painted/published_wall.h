// The proxy of Algorithm 1, as printed.
#pragma once

#include <memory>

#include "server/constraint/wall_proxy.h"

namespace handrail {

// Pixel tests a tick, or one whole scan where that is more: the printed loop has no bound.
inline constexpr int kMaxPixelTests = 2048;
// A hand this many pixels inside the wall still starts at the nearest free pixel.
inline constexpr int kNearbyPixels = 50;

// Among the pixels less than `search_radius` pixels from the proxy's, row by row from the top, the
// first that is not wall and nearer to the hand becomes the proxy's, and the scan starts again;
// when none is nearer the proxy is found. A pixel is wall if under half of it is open, and beyond
// the map's border. In the hand's own pixel the proxy is the hand, elsewhere the pixel's centre.
//
// The published method's faults are kept: the surface has steps of a pixel, so force has a ripple
// and the normal is off; the proxy stays behind in pockets, at a small radius even on slanting
// walls; a wall of w pixels holds only if w + 1 >= search_radius, and a diagonal of single pixels
// only up to a radius of sqrt(2), because nothing checks the way between two pixels. The hand's
// speed does not matter to that: the proxy goes from pixel to pixel.
//
// A hand deeper in a wall than kNearbyPixels, or a proxy that a returning wall buries deeper, is
// put to the scene's start. `walls` has a map and must outlive the proxy.
std::unique_ptr<WallProxy> make_published_proxy(const Walls& walls);

}  // namespace handrail
