// A recorded hand through one tool, in virtual time.
#pragma once

#include <cstdint>

#include "devices/hand/recorded_hand.h"
#include "server/base/status.h"
#include "server/model/scene.h"
#include "server/model/tool.h"

namespace handrail {

struct HandRunOptions {
  ToolKind tool = ToolKind::kLine;  // point, line or plane
  bool one_way = false;             // line, plane
  std::uint64_t seed = 1;           // of the rig
};

// Measured on the joints in the datagrams sent to the controller, through forward kinematics.
struct HandRunResult {
  std::size_t samples = 0;             // rows of the recording
  std::size_t gaps = 0;                // spacings over 250 ms, bridged
  double max_off_tool = 0.0;           // distance of the commanded tip from the tool [m]
  std::uint64_t backward_steps = 0;    // cycles in which it went back along the forward direction
  double max_joint_speed_ratio = 0.0;  // 1 = Table 3.1
  double max_force = 0.0;              // at the device [N]
  std::uint64_t non_finite = 0;        // values that were NaN or infinite, anywhere
};

// A cycle counts as backward when the tip recedes by more than this: the wire's 32-bit joint angles
// make a tip at 1 m jitter by up to about 0.3 um [m].
inline constexpr double kBackwardStep = 1e-6;

// Engages at J = (0, 0, 90, 0, 90, 0) with the hand on the first sample, calls the tool there
// (line: along device +X; plane: device XY, one-way along +X), plays the recording and lets the arm
// come to rest. Same input, same bits. The error says why the cell did not engage.
Result<HandRunResult> run_hand(const Scene& scene, const RecordedMotion& motion,
                               const HandRunOptions& options);

}  // namespace handrail
