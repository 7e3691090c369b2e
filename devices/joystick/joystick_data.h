// Data of the 2-DOF force-reflection joystick of dissertation chapter 2 (Table 2.1, Fig. 2.5): two
// AC servo motors, Panasonic MSMA041A1E, on a stick of 15 cm.
#pragma once

#include <cmath>
#include <numbers>

#include "devices/hand/hand_model.h"
#include "devices/haptic_device.h"

namespace handrail {

inline constexpr double kJoystickStick = 0.15;  // effective length [m]
// 3.8 N m peak; rated 400 W at 3000 rpm, 1.27 N m; 10000 counts a turn. At the tip:
inline constexpr double kJoystickPeakForce = 3.8 / kJoystickStick;    // 25.3 [N]
inline constexpr double kJoystickRatedForce = 1.27 / kJoystickStick;  // 8.5 [N]
inline constexpr double kJoystickResolution =
    2.0 * std::numbers::pi * kJoystickStick / 10000.0;  // 0.0942 mm [m]
inline constexpr double kJoystickHalf = 0.100;          // each way [m]
// Not published; our choice, at the tip. Stick and gimbal dominate the motors' inertia, and a
// stiffness of 5 N/mm held for 1 ms asks for at least 2.5 N s/m and 0.24 N.
inline constexpr double kJoystickMass = 0.3;       // [kg]
inline constexpr double kJoystickFriction = 0.3;   // Coulomb [N]
inline constexpr double kJoystickViscosity = 3.0;  // [N s/m]
// Low-pass of the velocity, our choice [Hz].
inline constexpr double kJoystickVelocityCutoff = 30.0;

// The velocity `dt` [s] after `v`, when the reading went from `before` to `p`: their difference,
// low-passed. [m/s]. Real-time safe.
inline Vec3 joystick_velocity(const Vec3& v, const Vec3& before, const Vec3& p,
                              double dt) noexcept {
  const double follow = -std::expm1(-2.0 * std::numbers::pi * kJoystickVelocityCutoff * dt);
  return v + follow * ((p - before) / dt - v);
}

inline HapticCapabilities joystick_capabilities() {
  HapticCapabilities c;
  c.name = "2-DOF joystick";
  c.simulated = true;
  c.max_force = kJoystickPeakForce;
  c.continuous_force = kJoystickRatedForce;
  c.dynamics = {.mass = kJoystickMass,
                .damping = kJoystickViscosity,
                .friction = kJoystickFriction,
                .resolution = kJoystickResolution,
                .source = "resolution as published; mass, friction and damping chosen"};
  c.workspace_half = Vec3(kJoystickHalf, kJoystickHalf, 1e-3);
  c.buttons = 2;
  c.velocity_lag = 1.0 / (2.0 * std::numbers::pi * kJoystickVelocityCutoff);
  c.least_mass = 0.5 + kJoystickMass;
  return c;
}

// A hand around the joystick's handle: 0.5 to 1.5 kg, 5 to 20 N s/m, 100 to 600 N/m (our ranges,
// from impedances published for arm and hand on a stick). `grip` from 0, relaxed, to 1, firm.
inline HandOptions joystick_grip(double grip = 0.5, std::uint64_t seed = 1) {
  HandOptions hand;
  hand.seed = seed;
  hand.mass = 1.0;
  hand.stiffness = 100.0 + 500.0 * grip;
  const double damping = 5.0 + 15.0 * grip;  // [N s/m]
  hand.damping_ratio = damping / (2.0 * std::sqrt(hand.stiffness * hand.mass));
  hand.wander_is_meant = true;
  return hand;
}

}  // namespace handrail
