// The part of the plane a scene's walls take up.
#pragma once

#include "server/model/walls.h"

namespace handrail {

struct View {
  Vec2 low = Vec2::Zero(), high = Vec2::Zero();  // frame of the walls [m]

  Vec2 centre() const { return 0.5 * (low + high); }
  Vec2 half() const { return 0.5 * (high - low); }
};

// A painted map as it is; drawn shapes with `margin` around them.
View view_of(const Walls& walls, double margin);

// Where a hand is after `t` seconds of wandering all over the view, from the walls' start at rest,
// at some 0.1 m/s; not bothered by walls. Frame of the walls.
Vec2 wander(const Walls& walls, const View& view, double t);

}  // namespace handrail
