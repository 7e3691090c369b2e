// What the haptic loop runs while a scene is loaded.
#pragma once

#include "server/haptic/haptic_step.h"
#include "server/haptic/wall_step.h"

namespace handrail {

struct LoopScene {
  HapticSettings haptic;
  WallRun* walls = nullptr;  // runs beside the step, with its force in place of an arm's; not owned
};

}  // namespace handrail
