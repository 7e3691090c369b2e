// What a scene simulates, on which side, and what each effect costs.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "server/base/status.h"
#include "server/model/scene.h"

namespace handrail {

struct PricedEffect {
  std::string name;
  bool on_rig = false;       // done by what stands in for devices, robot and hand; else the master
  double ns_per_tick = 0.0;  // of the haptic loop, on this machine
};

struct Explanation {
  std::string scene;
  std::vector<PricedEffect> effects;
  std::vector<std::string> not_simulated;
};

// Measures what each effect adds to a tick: the same step with and without it in turn, the median
// of the differences. Takes some seconds. A scene of walls is run with the joystick in a simulated
// hand that wanders through it; in any other one tools are on and the simulated arm touches what
// there is to touch. The error says what the arm cannot reach.
Result<Explanation> explain_scene(const Scene& scene, const std::atomic<bool>& cancelled);

}  // namespace handrail
