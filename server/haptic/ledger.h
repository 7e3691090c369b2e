// Where force and motion of a tick went. Every entry is a difference of two successive points, so
// the sums are exact.
#pragma once

#include <array>
#include <cstdint>

#include "server/base/spatial.h"
#include "server/haptic/arbiter.h"
#include "server/haptic/guide.h"
#include "server/model/link_state.h"
#include "server/model/reason.h"

namespace handrail {

// Force on the hand, frame M [N]. The others add up to `device`.
struct ForceLedger {
  Vec3 tool = Vec3::Zero();      // as the tool asks for
  Vec3 walls = Vec3::Zero();     // as walls, effects and a touched surface ask for
  Vec3 spring = Vec3::Zero();    // as the arm's lag asks for
  Vec3 governor = Vec3::Zero();  // what would have made energy
  Vec3 limits = Vec3::Zero();    // what budget, step limit and fade changed
  Vec3 clamp = Vec3::Zero();     // what the device's peak and its heat took
  Vec3 cue = Vec3::Zero();       // what says something to the hand
  Vec3 device = Vec3::Zero();
};

// Where `shares.device`, with `cue` in it, came from; `governor`: what that changed before the
// shares. Wanted forces that are not finite count as none, as they do to the arbiter. Real-time
// safe.
ForceLedger account(const ForceShares& shares, const Vec3& tool, const Vec3& walls,
                    const Vec3& spring, const Vec3& governor, const Vec3& cue) noexcept;

// From the hand to the arm, in order.
enum class MotionStage : std::uint8_t {
  kTool,         // the hand is not where the tool allows
  kSmoother,     // smoothing, and easing toward a new tool
  kLink,         // the command is on its way
  kTube,         // the slave's own tool
  kBumper,       // contact
  kReach,        // nearest reachable place
  kLimits,       // speed, acceleration and jerk of joints and tip
  kSingularity,  // near a singular pose
  kCount
};

// How far each stage moved the tip. They add up to X_ST_command.p - X_SH.p, the hand in S. A stage
// of ours that is neither a tool nor its easing has no reason: it smooths, or the link takes time.
struct MotionLedger {
  static constexpr int kStages = static_cast<int>(MotionStage::kCount);
  using Offsets = Eigen::Matrix<double, 3, kStages>;
  Offsets off_S = Offsets::Zero();  // [m]
  std::array<Reason, static_cast<std::size_t>(kStages)> why{};
  std::int8_t joint = -1;  // 0 to 5: the joint that limits; -1: none or all
  bool known = false;      // false: the hand does not lead the arm, the rest means nothing
  // Orientations in S on the way: the hand's, the tools', the command's, the arm's command's. The
  // slave does not say which of its stages turned the tip.
  Quat q_SH = Quat::Identity(), q_SP = Quat::Identity();
  Quat q_SU = Quat::Identity(), q_ST = Quat::Identity();
  double eased_angle = 0.0;  // of the turn from q_SP to q_SU: easing of a tool change [rad]
};

// From the hand at `X_SH` over the tools and the command, as the guide made them this tick, to
// where the slave says that it commands the arm: fills every field of `out`. Real-time safe.
void account(const Pose& X_SH, const Guidance& guidance, const SlaveState& slave,
             MotionLedger& out) noexcept;

}  // namespace handrail
