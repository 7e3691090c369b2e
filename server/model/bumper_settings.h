// What a scene says about contact.
#pragma once

#include <cstdint>

namespace handrail {

// Settings of the virtual bumper. The default form reads `contact` and below, the published one
// `dead_band`; the rest belongs to both.
struct BumperSettings {
  enum class Form : std::uint8_t { kDefault, kPublished };

  Form form = Form::kDefault;
  bool enabled = true;
  double alpha = 1e-5;       // compliance of (3.10) [m/N]
  double threshold = 50.0;   // f_th: nothing is pushed further in above it [N]
  double dead_band = 2.0;    // |f_e| below it counts as 0 [N]
  double contact = 10.0;     // three readings in a row above it are a contact [N]
  double friction = 0.3;     // largest coefficient of friction to expect
  double noise = 0.0;        // standard deviation of the sensor, each axis; widens every margin [N]
  double promise = 0.0;      // force that no approach may pass; 0: approach at any speed [N]
  double stiffest = 60e3;    // stiffest contact, arm and sensor in series, to reckon with [N/m]
  double sensor_lag = 1e-3;  // how much later than the joints a force is known, at most 0.1 [s]
};

}  // namespace handrail
