// What makes one simulated operator differ from another.
#pragma once

namespace handrail {

// SI. "Tip" quantities are at the robot's scale, as seen; "hand" ones at the hand. Values, ranges
// and sources stand in the population file; the defaults are its medians' order of magnitude.
struct OperatorParameters {
  // Seeing the tip.
  double vision_delay = 0.22;            // [s], 0 to 1
  double vision_noise_lateral = 1.4e-3;  // RMS of each axis across the line of sight, tip [m]
  double vision_noise_depth = 2.6e-3;    // RMS along the line of sight, tip [m]
  double vision_noise_angle = 0.02;      // RMS of each axis of the orientation seen [rad]
  double vision_noise_time = 1.5;        // correlation time of all three [s]
  // Planning.
  double plan_interval = 0.3;      // between submovements [s]
  double submovement = 0.6;        // duration of one [s]
  double speed = 0.041;            // preferred, tip [m/s]
  double turn_speed = 0.65;        // preferred [rad/s]
  double gain = 0.6;               // share of a seen error that is corrected
  double threshold = 3.7e-3;       // seen errors across the path below it are left, tip [m]
  double angle_threshold = 0.044;  // the same for orientation [rad]
  double tolerance = 3.7e-3;       // seen distance that counts as arrived, tip [m]
  double patience = 5.0;           // aiming for this long doubles what is tolerated [s]
  double pause = 0.74;             // deciding before each phase, practised once [s]
  double practice = 0.1;           // pause falls with the trial's number to this power
  // Moving.
  double motor_noise = 0.15;    // RMS of a submovement's end, share of its size
  double tremor = 0.05e-3;      // hand [m]
  double drift = 0.97e-3;       // hand [m]
  double drift_angle = 0.0122;  // [rad]
  double turn_lever = 0.004;    // tip straying per turn of the stylus, hand [m]
  double mass = 0.12;           // of hand and fingers [kg]
  double stiffness = 250.0;     // of the grip [N/m]
  double damping_ratio = 0.7;
  // Only with tools: calling one, and feeling a stop.
  double call_homing = 0.40;  // hand to the keys and back [s]
  double call_key = 0.28;     // one key press; two to a phase [s]
  double stop_force = 0.5;    // a stop pushes back harder than this to be noticed [N]
  double touch_delay = 0.16;  // reaction to what is felt [s]
  // Only with a key and a screw.
  double insert_tolerance = 1.3e-3;  // seen distance from the socket's axis that will do, tip [m]
  double insert_speed = 20e-3;       // lowering the key, tip [m/s]
  double press = 0.5e-3;             // the key is led this far past the socket's bottom, tip [m]
  double depth_memory = 0.5;         // share of that depth known from the last time, not from sight
  double half_turn = 2.8;            // the stylus is turned by so much at a time [rad]
  double lift = 12e-3;               // of the key above the rim, between turns, tip [m]
};

}  // namespace handrail
