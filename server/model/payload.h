// What hangs on the force sensor, and what the sensor reads without any contact.
#pragma once

#include "server/base/spatial.h"
#include "server/base/units.h"

namespace handrail {

// Axes of the flange, moments about the origin of a tip that is on its axis: the frame T of a scene
// that mounts none aside or turned. The default is nothing.
struct Payload {
  double mass = 0.0;             // of all that hangs on the sensor [kg]
  Vec3 centre_T = Vec3::Zero();  // of gravity [m]
  Wrench bias_T;                 // read without any force on the sensor

  bool is_none() const noexcept {
    return mass == 0.0 && bias_T.force.isZero(0.0) && bias_T.torque.isZero(0.0);
  }
  // What a resting sensor reads of it while the tip is turned by `q_ST`. Real-time safe.
  Wrench reading(const Quat& q_ST) const noexcept {
    const Vec3 weight = q_ST.conjugate() * Vec3(0, 0, -mass * kStandardGravity);
    return {weight + bias_T.force, centre_T.cross(weight) + bias_T.torque};
  }
  // The environment's part of `raw_T`, that is what is left without the reading above; all of it,
  // bit for bit, with no payload. What it takes to accelerate the mass stays. Real-time safe.
  Wrench remove(const Wrench& raw_T, const Quat& q_ST) const noexcept {
    if (is_none()) return raw_T;
    const Wrench own = reading(q_ST);
    return {raw_T.force - own.force, raw_T.torque - own.torque};
  }
};

}  // namespace handrail
