// Prices of the two kinds of scene; see explain.h.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "devices/haptic_device.h"
#include "server/base/status.h"
#include "server/haptic/haptic_step.h"
#include "server/lab/scenes/explain.h"
#include "server/model/scene.h"

namespace handrail {

// A hand that has wandered through the scene's walls for `seconds`, tick by tick: what the
// simulated joystick read. The same for the same scene.
std::vector<HandReading> wander_through(const Scene& scene, double seconds);

// Each effect the scene lists; empty when cancelled.
std::vector<PricedEffect> price_of_walls(const Scene& scene, const std::atomic<bool>& cancelled);

// A scene whose rig runs all but one of its effects.
struct RigWithout {
  std::string left_out;  // such as "plane", the second one "plane 2"
  Scene scene;
};
// One for each effect of the rig, in the scene's order; a screw's thread goes with its socket.
std::vector<RigWithout> rigs_without_each(const Scene& scene);

struct RigPrice {
  double step_ns = 0.0;               // of a millisecond of the rig, all effects
  std::vector<PricedEffect> effects;  // what each adds
};
// Of arm, sensor and workpiece on a course that touches it, averaged over it; empty when cancelled.
// The error says what the arm cannot reach.
Result<RigPrice> price_of_rig(const Scene& scene, const std::atomic<bool>& cancelled);

// What the master does for a scene without walls, and the hand at its device; empty when cancelled.
std::vector<PricedEffect> price_of_arm(const Scene& scene, const std::atomic<bool>& cancelled);

}  // namespace handrail
