// One push into a surface of given stiffness, under delay and friction, with the bumper between
// command and arm. The arm is a point that goes where it is told, at once or behind a servo's lag.
#pragma once

#include "server/follow/bumper.h"

namespace handrail {

struct BumperCase {
  double stiffness = 60e3;   // surface, sensor and arm in series [N/m]
  double speed = 0.01;       // of the command, toward the surface and along it [m/s]
  double delay = 0.0;        // in all, beside cycle and servo [s]
  double friction = 0.0;     // of the surface
  bool slanted = false;      // the push comes at 45 deg instead of straight
  bool gentle = false;       // to 30 N instead of at least 150 N and 3 mm deep
  bool late_sensor = false;  // the delay lies in the sensor instead of in the command
  double servo_lag = 0.0;    // of the arm, first order; 0: it is where it is told [s]
  double noise = 0.0;        // standard deviation of the sensor, each axis [N]
  double lag_error = 0.0;    // by this share the law takes its delay too long
  double cycle = 0.0071;     // [s]
};

// What came of it. The command goes in, holds, slides there and back, holds, and goes out.
struct BumperRun {
  double inward = 0.0;    // largest step into the surface while more than f_th was measured [m]
  double peak = 0.0;      // largest true force along the normal [N]
  double swing = 0.0;     // peak to peak in the last second of either hold [N]
  double settled = 0.0;   // mean force of the last second [N]
  double share = 0.0;     // speed at the first touch, of the command's or of what a promise allows
  int hops = 0;           // times the surface was left while sliding
  bool released = false;  // the way out was followed to its end
};

BumperRun run_bumper(const BumperSettings& settings, const BumperCase& of);

// f_th + k_e v (D + 2.5 T): what a peak may come to, noise or not [N].
double peak_bound(const BumperSettings& settings, const BumperCase& of) noexcept;

}  // namespace handrail
