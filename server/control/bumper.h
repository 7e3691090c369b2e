// Virtual bumper (dissertation 3.2.3, equation 3.10 and Algorithm 3).
#pragma once

#include "server/base/spatial.h"

namespace handrail {

struct BumperSettings {
  bool enabled = true;
  double alpha = 1e-5;      // [m/N], 0.01 mm/N
  double threshold = 50.0;  // f_th [N]
  double dead_band = 2.0;   // |f_e| below this counts as 0: the sensor's noise is not a contact [N]
};

struct Bumped {
  Vec3 p_SB = Vec3::Zero();  // adjusted command [m]
  bool acting = false;       // the force is above the threshold and the command was held back
};

// Algorithm 3. `p_SU`: the user's command; `f_E`: force of the environment on the tip, frame S,
// finite; `p_last`: the position last commanded to the arm (after all limits: a bumper that
// remembered its own output would let the arm go on toward it). Moving away from the contact is
// always free; a pure push into it returns the previous command. The published step backs off by
// |d| - |d_n| on a slanting push. Real-time safe.
inline Bumped bump(const BumperSettings& settings, const Vec3& p_SU, const Vec3& f_E,
                   const Vec3& p_last) noexcept {
  const double force = f_E.norm();
  if (!settings.enabled || force < settings.dead_band) return {p_SU, false};
  const Vec3 adjusted = p_SU + settings.alpha * f_E;  // (3.10)
  if (force <= settings.threshold) return {adjusted, false};
  const Vec3 d = adjusted - p_last;
  if (d.dot(f_E) >= 0.0) return {adjusted, false};
  return {adjusted + d.norm() * f_E / force, true};
}

}  // namespace handrail
