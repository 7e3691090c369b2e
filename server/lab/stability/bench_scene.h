// Scenes for bare devices.
#pragma once

#include "server/lab/stability/wall_cell.h"
#include "server/model/scene.h"

namespace handrail {

// Walls at X = 0, at Y = 0 too for a corner, in front of free space; the effects of the cell about
// the origin of a region that is of every kind at once. Effects are as strong as the device lets.
Scene bench_scene(const WallCell& cell);

}  // namespace handrail
