// Data of the SensAble Phantom Omni (now 3D Systems Touch), from its data sheet unless said
// otherwise.
#pragma once

#include <numbers>

#include "devices/haptic_device.h"
#include "server/base/spatial.h"

namespace handrail {

inline constexpr double kOmniPeakForce = 3.3;         // [N]
inline constexpr double kOmniContinuousForce = 0.88;  // [N]
inline constexpr double kOmniFriction = 0.26;         // back-drive friction at the tip [N]
inline constexpr double kOmniMass = 0.045;            // apparent, at the tip [kg]
inline constexpr double kOmniResolution = 0.055e-3;   // [m]
// Low-pass of the velocity, our choice [Hz].
inline constexpr double kOmniVelocityCutoff = 30.0;
// The torque variant does not exist as a product; our choice, between a fingertip's comfort and
// what larger devices of the family give [N m].
inline constexpr double kOmniTorque = 0.2;
// Of turning the stylus. The inertia is that of a rod of 15 cm, the stylus' length, as heavy as the
// apparent mass, about its middle: m l^2 / 12. The damping is chosen: held for a period of 1 ms it
// holds springs of 2 b / T = 1 N m/rad, twice what orientation tools are unless a scene says more.
inline constexpr double kOmniInertia = kOmniMass * 0.15 * 0.15 / 12.0;  // [kg m^2]
inline constexpr double kOmniTurnDamping = 5e-4;                        // [N m s/rad]
// The orientation is read as it is: as good as without counts [rad].
inline constexpr double kOmniTurnResolution = 1e-9;

// Half of the nominal 160 x 120 x 70 mm [m].
inline Vec3 omni_workspace_half() { return {0.080, 0.060, 0.035}; }

// What the device can do; with `torque`, the variant that turns the stylus too.
inline HapticCapabilities omni_capabilities(bool torque) {
  HapticCapabilities c;
  c.name = torque ? "Phantom Omni with torque" : "Phantom Omni";
  c.simulated = true;
  c.senses_rotation = true;
  c.actuates_torque = torque;
  c.max_force = kOmniPeakForce;
  c.continuous_force = kOmniContinuousForce;
  c.max_torque = torque ? kOmniTorque : 0.0;
  // No viscous damping is published, and little of it is felt: none is counted on.
  c.dynamics = {.mass = kOmniMass,
                .friction = kOmniFriction,
                .resolution = kOmniResolution,
                .source = "data sheet; viscous damping not published"};
  if (torque) {
    c.turning = {.mass = kOmniInertia,
                 .damping = kOmniTurnDamping,
                 .resolution = kOmniTurnResolution,
                 .source = "chosen, no such product exists"};
  }
  c.workspace_half = omni_workspace_half();
  c.buttons = 2;
  c.velocity_lag = 1.0 / (2.0 * std::numbers::pi * kOmniVelocityCutoff);
  return c;
}

}  // namespace handrail
