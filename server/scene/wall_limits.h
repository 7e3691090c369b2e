// What stiffness of walls a device can hold.
#pragma once

#include <string>
#include <vector>

#include "server/scene/walls.h"

namespace handrail {

// The device as its wall feels it, SI; 0: not known, and then not asked.
struct WallDevice {
  double period = 1e-3;        // T of the haptic loop [s]
  double damping = 0.0;        // b, viscous, of the device alone [N s/m]
  double friction = 0.0;       // f_c, Coulomb [N]
  double resolution = 0.0;     // Delta, step of the position read [m]
  double max_stiffness = 0.0;  // highest known to render stably [N/m]
};

// The stiffest wall of damping `wall_damping` that the device renders without giving energy:
// min(2 (b - B) / T, 2 f_c / Delta, max_stiffness), 0 or more; infinite when nothing is known.
// Source: Colgate and Schenkel 1997, Abbott and Okamura 2005.
double stiffness_limit(const WallDevice& device, double wall_damping) noexcept;

// One sentence for each wall region that is stiffer, with the consequence. A limit of passivity: a
// hand that holds the device usually takes more, so it warns and does not refuse.
std::vector<std::string> stiffness_warnings(const Walls& walls, const WallDevice& device);

}  // namespace handrail
