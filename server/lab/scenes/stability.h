// What of a scene's walls, tools and springs a device can hold.
#pragma once

#include <string>

#include "server/model/scene.h"

namespace handrail {

// On the simulated device that stands in where no other is named: the joystick for walls, the Omni
// for an arm. Both with the governor on.
std::string stability_text(const Scene& scene);  // a line for each
std::string stability_json(const Scene& scene);  // a pb::RenderingReport

}  // namespace handrail
