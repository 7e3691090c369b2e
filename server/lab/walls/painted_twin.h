// A drawn scene as an image editor would paint it.
#pragma once

#include "server/model/walls.h"

namespace handrail {

// `drawn` as a map of square pixels of `pixel` [m], felt by `method`, which is no kExact. Each
// pixel holds how much of it is free, of 16 x 16 points, in 256 steps as an 8-bit image does. The
// shapes stay beside the map: what looks for the way among them finds it. Takes a second.
Walls painted_twin(const Walls& drawn, double pixel, WallMethod method);

}  // namespace handrail
