// Data of the device that a page's cursor leads: there is none to buy, so these are choices.
#pragma once

#include <numbers>

#include "devices/hand/hand_model.h"
#include "devices/haptic_device.h"
#include "devices/joystick/joystick_data.h"

namespace handrail {

// The work space of the 2-DOF joystick, whose scenes it plays, and as much across.
inline constexpr double kPageHalf = kJoystickHalf;  // each way [m]
// As the joystick's, so that its scenes are as stable; no motor gets warm.
inline constexpr double kPageForce = kJoystickPeakForce;  // [N]
inline constexpr double kPageMass = kJoystickMass;
inline constexpr double kPageFriction = kJoystickFriction;
inline constexpr double kPageViscosity = kJoystickViscosity;
// Of a number in a message: far below what a picture shows [m].
inline constexpr double kPageResolution = 1e-5;
// Low-pass of the velocity, our choice [Hz].
inline constexpr double kPageVelocityCutoff = 30.0;
// A cursor of 60 to 125 samples a second becomes a smooth motion: two lags of this, twice the
// longest time between two samples [s].
inline constexpr double kPageSmoothing = 0.016;

inline HapticCapabilities page_capabilities() {
  HapticCapabilities c;
  c.name = "page";
  c.simulated = true;
  c.senses_rotation = true;
  c.led_by_cursor = true;
  c.max_force = kPageForce;
  c.continuous_force = kPageForce;
  c.dynamics = {.mass = kPageMass,
                .damping = kPageViscosity,
                .friction = kPageFriction,
                .resolution = kPageResolution,
                .source = "chosen, as the joystick's"};
  c.workspace_half = Vec3::Constant(kPageHalf);
  c.buttons = 3;
  c.velocity_lag = 1.0 / (2.0 * std::numbers::pi * kPageVelocityCutoff);
  c.least_mass = 0.5 + kPageMass;
  return c;
}

// The hand that leads it: as one around a handle, but a person moves it, so that it does not wander
// by itself.
inline HandOptions page_hand() {
  HandOptions hand = joystick_grip();
  hand.tremor_rms = hand.drift_rms = hand.drift_rotation_rms = 0.0;
  hand.reaction = 0.0;
  return hand;
}

}  // namespace handrail
