// How the tip moves in a step of the world.
#pragma once

#include "server/base/spatial.h"

namespace handrail {

struct TipStep {
  Vec3 x_last = Vec3::Zero();  // where it stood, frame S
  Vec3 x0 = Vec3::Zero();      // where it would be with nothing to touch
  Vec3 y = Vec3::Zero();       // where it would be if all forces stayed: which face it may reach
  Quat q = Quat::Identity();   // q_ST
};

}  // namespace handrail
