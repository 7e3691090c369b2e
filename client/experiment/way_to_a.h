// How the arm comes to where a trial begins: it puts down what it holds, goes there by itself,
// waits with the clutch closed, as in the simulated studies, and picks the work up. The hand is
// free meanwhile.
#pragma once

#include <optional>

#include "proto/operator.pb.h"
#include "server/base/spatial.h"

namespace handrail {

// So near to A, and so near to upright, the arm has come.
inline constexpr double kNearA = 1e-3;         // [m]
inline constexpr double kNearUpright = 0.017;  // 1 deg [rad]

// What the status says of that.
struct StartSight {
  Pose X_ST;  // measured
  bool drives = false, clutched = false;
  bool tool = false;          // any is called
  std::optional<Vec3> point;  // where a point tool is, that is called [m]
  std::optional<Quat> kept;   // what an N-rotation keeps, that is called
  bool turning = false;       // it still turns the tip
  bool gripper = false;       // there is one, to pick the work up with
  bool closed = false;        // and it is closed
};

// The next order on the way, or none: the arm is there, or is not there yet, or nobody drives it.
// Asked again once the order has been answered. Pure.
std::optional<pb::Request> order_to_a(const StartSight& now, const Pose& X_SA);

}  // namespace handrail
