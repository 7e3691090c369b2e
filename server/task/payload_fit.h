// Identification of what hangs on the force sensor, from its readings at rest in several
// orientations.
#pragma once

#include <cstddef>
#include <span>

#include "server/base/status.h"
#include "server/model/payload.h"

namespace handrail {

// One orientation: means over a time at rest, touching nothing.
struct PayloadSample {
  Quat q_ST = Quat::Identity();
  Wrench raw_T;               // what the sensor read, axes of the tip frame
  double force_noise = 0.0;   // standard deviation of each axis of that mean [N]
  double torque_noise = 0.0;  // [N m]
};

inline constexpr std::size_t kFewestPayloadSamples = 4;

struct PayloadFit {
  Payload payload;
  double force_left = 0.0;   // root mean square of what no payload explains, each axis [N]
  double torque_left = 0.0;  // [N m]
};

// How far apart the directions of gravity in the tip frame lie: standard deviation across the axis
// along which they differ most [rad], 0.18 for a circle of 15 deg to either side. Turning the tip
// about the vertical adds nothing.
double payload_spread(std::span<const PayloadSample> samples) noexcept;
inline constexpr double kLeastPayloadSpread = 0.18;

// Least squares for mass, centre and bias; with less than 0.2 N of weight mass is 0 or next to it
// and the centre is left at the origin. Errors, in this order: fewer than 4 samples; orientations
// too much alike; readings that no payload explains, beyond their noise by 3 % of the weight or
// 0.15 N (the arm touched something or moved); a weight that points up (the sensor's sign is
// reversed). May allocate.
Result<PayloadFit> fit_payload(std::span<const PayloadSample> samples);

}  // namespace handrail
