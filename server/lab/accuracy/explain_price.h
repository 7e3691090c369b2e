// Prices of the two kinds of scene; see explain.h.
#pragma once

#include <atomic>
#include <vector>

#include "devices/haptic_device.h"
#include "server/control/haptic_step.h"
#include "server/lab/accuracy/explain.h"
#include "server/scene/scene.h"

namespace handrail {

// A hand that has wandered through the scene's walls for `seconds`, tick by tick: what the
// simulated joystick read. The same for the same scene.
std::vector<HandReading> wander_through(const Scene& scene, double seconds);

// Each effect the scene lists; empty when cancelled.
std::vector<PricedEffect> price_of_walls(const Scene& scene, const std::atomic<bool>& cancelled);

// What the master does and the rig simulates for a scene without walls; empty when cancelled.
std::vector<PricedEffect> price_of_arm(const Scene& scene, const std::atomic<bool>& cancelled);

}  // namespace handrail
