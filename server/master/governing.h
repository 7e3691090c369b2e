// What the governor does with a scene on a device: what is rendered, how near that is to the
// device's limits, and what is rendered less stiff than asked for.
#pragma once

#include <string>
#include <vector>

#include "devices/haptic_device.h"
#include "server/model/scene.h"
#include "server/stability/energy_governor.h"
#include "server/stability/rendering.h"

namespace handrail {

// Of this much of a limit the governor renders at most: on the limit itself an oscillation would
// last. The choice is the middle of what a tenth of room leaves.
inline constexpr double kGoverned = 0.95;

struct CheckedRendering {
  Rendering rendering;
  StabilityMargin margin;
  // Its other end is told over the link: what it may give back is bounded while it runs, and it
  // stays as stiff as the scene says.
  bool bounded = false;
  // Nothing else comes down with it: torque, and the surface that is touched.
  bool by_itself = false;
  // Of its stiffness and its damping, what is rendered with the governor on. Walls and effects come
  // down together, all as far as the one that has to most; and so do the dampers of tools, whose
  // springs come down as far as each has to beside them.
  double share = 1.0;
  double damping_share = 1.0;
};

RenderingLoop rendering_loop(const HapticCapabilities& device);
// The same of turning the stylus, for a device with torque.
RenderingLoop turning_loop(const HapticCapabilities& device);

GovernorSettings governor_settings(const HapticCapabilities& device, bool on);
// In N m and rad; off for a device without torque.
GovernorSettings turn_governor_settings(const HapticCapabilities& device, bool on);

// Forces, and of a device with torque what turns.
std::vector<CheckedRendering> check_renderings(const Scene& scene,
                                               const HapticCapabilities& device);

// The least of what the device's margins leave of the forces that are not bounded: what walls and
// effects are rendered at, and the dampers of tools.
double governed_share(const std::vector<CheckedRendering>& checked);

// The device's declared data and their source, then a line for each: margin, what limits it, and
// what the governor does.
std::vector<std::string> stability_lines(const std::vector<CheckedRendering>& checked,
                                         const HapticCapabilities& device, bool governor);

// One sentence for each that is not rendered as the scene says, or, with the governor off, that is
// not stable.
std::vector<std::string> stability_warnings(const std::vector<CheckedRendering>& checked,
                                            const HapticCapabilities& device, bool governor);

}  // namespace handrail
