// How a force sensor sits on the flange.
#pragma once

#include <cmath>
#include <string>

#include "devices/ft_sensor.h"
#include "server/base/plain_text.h"
#include "server/base/spatial.h"
#include "server/base/units.h"

namespace handrail {

// The sensor's frame F, measured in axes of the flange with the origin at the tip T: where its
// reference point is, and how it is turned. The default: F is T. On the handle of a haptic device
// the handle takes the flange's place, and the hand's reference point H the tip's.
struct FtMount {
  Pose X_TF;
};

// What a sensor so mounted feels, as a wrench at the tip: turned into the flange's axes, and its
// torque moved from the sensor's reference point to the tip. [N], [N m]. Real-time safe.
inline Wrench at_tip(const FtMount& mount, const Wrench& f_E_F) noexcept {
  const Vec3 force = mount.X_TF.q * f_E_F.force;
  return {force, mount.X_TF.q * f_E_F.torque + mount.X_TF.p.cross(force)};
}

// "mount { ... } " of a force sensor's block; empty: it is the default.
inline std::string mount_block(const FtMount& mount) {
  const auto three = [](const char* field, const Vec3& v) {
    if (v.isZero(0.0)) return std::string();
    const auto rounded = [](double value) { return number_text(std::round(1e6 * value) / 1e6); };
    return std::string(field) + ": [" + rounded(v[0]) + ", " + rounded(v[1]) + ", " +
           rounded(v[2]) + "] ";
  };
  const std::string inner =
      three("turn_deg", rotation_log(mount.X_TF.q) / kDeg) + three("offset_mm", mount.X_TF.p / kMm);
  return inner.empty() ? "" : "mount { " + inner + "} ";
}

}  // namespace handrail
