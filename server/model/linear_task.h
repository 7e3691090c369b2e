// The linear-movement task (dissertation 3.4.1): straight from A to B, turn about B, straight to C.
#pragma once

#include "server/base/spatial.h"

namespace handrail {

// Frame S. The three points are pairwise different.
struct LinearTask {
  Vec3 p_SA = Vec3::Zero();  // start [m]
  Vec3 p_SB = Vec3::Zero();  // [m]
  Vec3 p_SC = Vec3::Zero();  // end [m]
  // Nominal orientation from A to B: the tip points straight down, as at J = (0, 0, 90, 0, 90, 0).
  Quat q_first = Quat(0.0, 0.0, 1.0, 0.0);
  Vec3 turn = Vec3::Zero();  // re-orientation about B, rotation vector in S [rad]

  // Nominal orientation from B to C.
  Quat q_second() const { return (rotation_exp(turn) * q_first).normalized(); }
};

enum class LinearPhase { kToB, kTurn, kToC };
inline constexpr int kLinearPhases = 3;

}  // namespace handrail
