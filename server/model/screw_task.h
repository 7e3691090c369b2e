// The screw-fastening task (dissertation 3.4.2): tighten a screw with a ball-ended hex key, half a
// turn at a time.
#pragma once

#include "server/base/spatial.h"
#include "server/base/units.h"

namespace handrail {

// Where the socket is stands in what the scene simulates: it is not said twice.
struct ScrewTask {
  Vec3 start = Vec3(2e-3, 0.0, 12e-3);  // of the tip from the centre of the socket's rim, S [m]
  double tight = 540.0 * kDeg;          // the screw has to be turned by this [rad]
  double clear = 10e-3;                 // and the key to be this far above the rim [m]
};

// What the operator is doing.
enum class ScrewPhase { kAlign, kInsert, kSeek, kTurn, kLift, kReturn };

}  // namespace handrail
