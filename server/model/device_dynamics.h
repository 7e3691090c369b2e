// What a haptic device is to the force that a loop renders at it.
#pragma once

namespace handrail {

// Of the moving parts as felt at the tip, without a hand, in the direction in which there is least
// of it. Of turning the stylus the same numbers are in kg m^2, N m s/rad, N m, rad and s. SI. What
// a device does not declare is 0, and counts as none: a device of unknown mass is never taken for
// one that is easily kept stable.
struct DeviceDynamics {
  double mass = 0.0;        // apparent [kg]
  double damping = 0.0;     // viscous [N s/m]
  double friction = 0.0;    // Coulomb [N]
  double resolution = 0.0;  // of the position it reads [m]
  double delay = 0.0;       // of a force, from the position that it is for, beside being held [s]
  const char* source = "";  // where these are from; static storage
};

}  // namespace handrail
