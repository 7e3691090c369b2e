// The arm's tip as the rig's controller was told it, over time.
#pragma once

#include <vector>

#include "devices/rig/tap.h"
#include "server/base/spatial.h"

namespace handrail::faults {

struct TipAt {
  Nanos at = 0;
  Vec3 p = Vec3::Zero();  // frame S [m]
};

// Of each cycle in [from, to].
std::vector<TipAt> tips_of(const TapFile& tap, Nanos from, Nanos to);

// How far the tip goes back, at most, on a way that has one direction, from its first place to its
// last [m]. 0 where it has no length.
double backward(const std::vector<TipAt>& way);

// Where the master asked the tip to be, at some moments.
using Asked = std::vector<TipAt>;

// Root mean square of the distance between what was asked and the tip at that time [m]; 0: nothing
// to compare.
double tracking_error(const std::vector<TipAt>& way, const Asked& asked);

}  // namespace handrail::faults
