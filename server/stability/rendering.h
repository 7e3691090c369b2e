// What a scene renders at the hand, and how far that is from what a device can hold.
#pragma once

#include <string>
#include <vector>

#include "server/model/device_dynamics.h"
#include "server/model/scene.h"

namespace handrail {

// A spring and a damper between the hand and something at rest. >= 0.
struct Rendering {
  std::string name;
  double stiffness = 0.0;     // [N/m]
  double damping = 0.0;       // [N s/m]
  bool own_velocity = false;  // damps by differences of its own, not by the device's velocity
  double delay = 0.0;         // between measuring and force, beside the period that it is held [s]
  bool turns = false;         // of turning: [N m/rad], [N m s/rad], and torque in place of force
};

// How the loop renders it. > 0 unless said otherwise.
struct RenderingLoop {
  double period = 1e-3;       // [s]
  double velocity_lag = 0.0;  // of the low-pass of the device's velocity, >= 0 [s]
  double peak = 3.3;          // largest force of the device [N], of turning its torque [N m]
  double least_mass = 0.05;   // of device and a light hand together [kg]
};

// What decides how much can be rendered.
enum class StabilityLimit {
  kLoop,      // the sampled loop: the linear device's own damping, and the damping rendered
  kFriction,  // the device's friction takes more than an oscillation within its peak force makes
  kCounts,    // friction holds the hand where a count of the encoder pushes it no further
  kUnknown,   // of a device of unknown mass, only what is passive with its damping counts
  kInvalid,   // a number that is none: nothing can be shown
};

// In words, static storage.
const char* name_of(StabilityLimit limit) noexcept;

// `share`: this many times as stiff and damping it would be where some oscillation of the device
// alone does not die away; below 1 it is there already. May be infinite.
struct StabilityMargin {
  double share = 0.0;
  StabilityLimit by = StabilityLimit::kInvalid;
};

// Of one rendering. The linear loop is exact, but that a rendering's own delay is taken to be whole
// periods, no shorter than it is. Or friction does, where what is rendered beside it that damps
// takes energy: beyond the peak force F an oscillation makes less and less beside what friction
// takes of it, and at no amplitude more while 0.860 F (K (T/2 + d) - b) <= f_c sqrt(K m); and while
// a count D pushes no harder than friction holds, K D / 2 <= f_c (Diolaiti et al. 2006). A device
// that does not declare its counts has no friction to count on. Allocates.
StabilityMargin margin_of(const DeviceDynamics& device, const RenderingLoop& loop,
                          const Rendering& rendering);

// The stiffest spring with a damper of `damping` [N s/m] that every oscillation of the device alone
// dies away at [N/m]; of a device of unknown mass the stiffest that its damping takes up, whatever
// hand holds it. 0: none can be shown to be. As margin_of(), without a delay of the rendering's
// own.
double most_stiffness(const DeviceDynamics& device, const RenderingLoop& loop, double damping);

// The same of the surface that the tip touches: without a tool nothing damps it, along a slanted
// tool that tool's damper does.
double most_surface_stiffness(const DeviceDynamics& device, const RenderingLoop& loop,
                              double damping);

// All that `scene` renders: each tool, wall and spring, and last, where several can act at the same
// place, all of them together. What makes up by itself for being held for a period counts with the
// damper by which it does.
std::vector<Rendering> renderings_of(const Scene& scene, const RenderingLoop& loop);

// The surface that the tip touches, where `scene` has the master render it: no stiffer than its
// tools.
std::vector<Rendering> touched_of(const Scene& scene);

// The torque springs of the orientation tools of `scene`, none of a scene of walls. They give less
// beyond 2.6 rad, nowhere more.
std::vector<Rendering> turnings_of(const Scene& scene);

}  // namespace handrail
