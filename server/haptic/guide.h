// The guide: the two active tools, the proxies on them, and the smoothed command they give.
#pragma once

#include "server/constraint/orientation_tool.h"
#include "server/constraint/position_tool.h"
#include "server/haptic/smoother.h"
#include "server/model/reason.h"
#include "server/model/tool_call.h"
#include "server/session/blend.h"

namespace handrail {

// A tool without stiffness still divides: so much is nothing to a hand [N/m], [N m/rad].
inline constexpr double kSoftest = 1e-3;

struct GuideSettings {
  GuidanceMethod method = GuidanceMethod::kExact;
  double delta = 2e-4;                 // published method's step in S [m]
  double stiffness = 800.0;            // K_t where a tool does not say [N/m]
  double most_stiffness = 1e9;         // no tool is rendered stiffer, whatever it says [N/m]
  double torque_stiffness = 0.5;       // K_N, K_F where a tool does not say [N m/rad]
  double most_torque_stiffness = 1e9;  // as most_stiffness [N m/rad]
  double catch_up = 0.060;             // bound on letting go of a position offset [m/s]
  double catch_up_rotation = 0.262;    // the same for orientation [rad/s]
  bool chase = false;                  // a released orientation goes to the hand at most so fast
  double reach = 0.020;                // furthest that a change of position tools moves the arm [m]
  // Bound on easing a tool's pull in after a change, at the hand, times the mapping's scale: the
  // pull is in S [N/s]. With the arbiter's step limit (0.05 N a millisecond) it leaves room for the
  // spring.
  double force_rate = 50.0;
  int smoother_length = 200;  // N of (3.11)
};

// What the guide makes of the hand this tick, frame S.
struct Guidance {
  Pose X_SC;                       // smoothed command for the tip
  Pose X_SP;                       // proxy on the tools
  Vec3 pull = Vec3::Zero();        // proxy minus hand, eased across tool changes [m]
  Vec3 twist_pull = Vec3::Zero();  // rotation vector from hand to proxy, eased [rad]
  bool blending = false;           // an offset of a tool change is still being let go
  bool beyond = false;             // the command was drawn back to where a place ends (kFarthest)
  Vec3 offset = Vec3::Zero();      // how much of X_SC.p is that [m]
  double offset_angle = 0.0;       // and of X_SC.q [rad]
};

// Tools, proxies, smoothers and the two offsets that keep a tool change smooth.
//
// A tool called while the command is elsewhere pulls both command and force over a bounded time:
// the command keeps an offset that shrinks by at most `catch_up`, the force one that shrinks by at
// most `force_rate`. A tool called without an anchor is anchored at the command, whose offset is
// then zero from the first tick on. Orientation offsets multiply on the right (in the tip's own
// frame), so that hand rotation passes 1:1 in S while they decay.
//
// No change of position tools moves the arm by itself further than `reach`. A tool further from the
// tip, or from the command that it follows, is refused, or approached: then the hand is taken to be
// where the tool is nearest, so that nothing pulls it there. An approach ends when the command has
// come to the tool, and with any other change of position tools. A hand that a tool held back
// further than `reach` is taken to be where the command is, once another tool, or none, would let
// the arm go to it.
//
// Orientation tools hold what they find, and then none turns the arm by itself. One that has a
// reference brings the command there, from however far, by at most `catch_up_rotation`. Meanwhile,
// and afterwards, the hand is taken to be turned as the reference wants: nothing turns it there,
// and a tool that is dropped then leaves the arm as it stands. Any other change of orientation
// tools ends the way there.
//
// With `chase` a released orientation is let go as published: the command follows the hand at
// `catch_up_rotation` at most until it has caught up, and winds up behind a hand that turns faster.
// Real-time safe; no allocation.
class Guide {
 public:
  // Starts afresh at `X_SC`, where hand and command both stand. Active tools stay, their proxies
  // restart there: with a still hand nothing moves, unless a tool has yet to be reached. Returns
  // where the hand is taken to be: turned as a reference wants that has yet to be reached.
  Pose restart(const GuideSettings& settings, const Pose& X_SC) noexcept;

  // Calls a tool in its slot. `X_SH`: the hand now, in S, and afterwards where it is taken to be:
  // the caller latches it there. `p_ST`: the tip of the arm. Refuses what cannot be anchored or is
  // too far and then changes nothing. `distance`, if not null: of an anchored position tool, with
  // its end, from the tip or, where that is more, from the command [m]; else left alone.
  Reason call(const GuideSettings& settings, const ToolCall& call, const Vec3& p_ST, Pose& X_SH,
              double* distance = nullptr) noexcept;

  // Drops a tool; kNoSuchTool when the slot is empty. `X_SH` as above.
  Reason drop_position(const GuideSettings& settings, Pose& X_SH) noexcept;
  Reason drop_orientation(const GuideSettings& settings, Pose& X_SH) noexcept;

  // One tick: hand pose in S -> command and pull. dt [s].
  Guidance step(const GuideSettings& settings, const Pose& X_SH, double dt) noexcept;

  const PositionTool& position() const noexcept { return position_; }
  const OrientationTool& orientation() const noexcept { return orientation_; }
  const Pose& command() const noexcept { return command_; }
  const Pose& proxy() const noexcept { return proxy_; }
  // The command is on its way to a tool it was called for from afar.
  bool approaching() const noexcept { return approaching_; }
  // The command turns to the reference of an orientation tool, or will once the hand drives.
  bool turning() const noexcept { return turning_; }
  // Stiffness at the hand of the active position tool; the settings' one without a tool [N/m].
  double stiffness(const GuideSettings& settings) const noexcept;
  double torque_stiffness(const GuideSettings& settings) const noexcept;

 private:
  void change_position(const GuideSettings& settings, const PositionTool& tool, bool approach,
                       Pose& X_SH) noexcept;
  // `brings`: the tool has a reference.
  void change_orientation(const GuideSettings& settings, const OrientationTool& tool, bool brings,
                          Pose& X_SH) noexcept;
  Quat chase(const GuideSettings& settings, const Quat& q_SC, const Quat& q_wanted,
             double dt) noexcept;
  // Restarts the orientation smoother at `q_proxy`, keeping the command continuous.
  void rejoin_orientation(const GuideSettings& settings, const Quat& q_proxy) noexcept;

  PositionTool position_;
  OrientationTool orientation_;
  PositionSmoother position_mean_;
  OrientationSmoother orientation_mean_;
  Pose proxy_;  // on the tools, without offsets
  Pose command_;
  Blend command_offset_;  // S [m]
  Blend command_turn_;    // tip frame, rotation vector [rad]
  Blend pull_offset_;     // S [m]
  Blend twist_offset_;    // S, rotation vector [rad]
  std::uint32_t next_id_ = 1;
  bool approaching_ = false;
  bool brings_ = false;  // the orientation tool has a reference
  bool turning_ = false;
  bool chasing_ = false;  // a released orientation has not caught up with the hand
};

// Anchors `call` at `X_SC` where it does not name its own place and normalises directions.
// Returns kNone and fills `tool` (without id and epoch), or says why not. Real-time safe.
Reason anchor(const ToolCall& call, const GuideSettings& settings, const Pose& X_SC,
              ToolDefinition& tool) noexcept;

}  // namespace handrail
