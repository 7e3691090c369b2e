// What leaving an effect out of a scene saves, measured on the machine that asks.
#pragma once

#include <vector>

#include "server/haptic/wall_step.h"
#include "server/master/wall_runs.h"

namespace handrail {

struct EffectPrice {
  EffectKind kind = EffectKind::kWall;
  double ns = 0.0;  // by which a tick is shorter in the scene without it; below 0 by noise
};

struct StepPrice {
  double step_ns = 0.0;              // the master's step with all its effects, median
  double device_ns = 0.0;            // the simulated device's tick with all its effects, median
  std::vector<EffectPrice> effects;  // in the scene's order
};

// Steps the scene over `motion`, a hand's readings of 1 ms each (not empty), and beside it one
// scene for each effect that lists all others, made ready as the master does: short blocks of the
// same readings in turn, `rounds` of them, so that whatever slows the machine slows all alike. A
// price is the median over the rounds of the difference, and the median over `builds`, each with
// everything elsewhere in memory. Effects of the simulated device are timed on the joystick in a
// hand, the others on the step. Shares nothing with what `scene explain` measures, so that each
// checks the other. May block; allocates before it measures.
StepPrice price_effects(const Scene& scene, const HapticCapabilities& device,
                        const std::vector<HandReading>& motion, int rounds = 400, int builds = 5);

}  // namespace handrail
