// An order to call a virtual tool, before it is anchored: what scenes and operators ask for.
#pragma once

#include <string>

#include "server/model/reason.h"
#include "server/model/tool.h"

namespace handrail {

// Robot base frame S, SI. Directions need not be unit vectors; a zero vector means "not given".
// Fields the kind does not use are ignored.
struct ToolCall {
  ToolKind kind = ToolKind::kNone;
  bool at_present = true;           // anchor at the commanded tip of the moment; p_SA unused
  Vec3 p_SA = Vec3::Zero();         // anchor [m]
  Vec3 direction_S = Vec3::Zero();  // line: forward; plane: forward within the plane
  Vec3 normal_S = Vec3::Zero();     // plane: its normal
  Vec3 axis_S = Vec3::Zero();       // F-rotation with has_axis: the axis kept
  bool has_axis = false;            // else F-rotation keeps the tool's own axis as it points now
  // F-rotation with has_axis_T: the tip's axis that is brought onto axis_S; else the one that
  // lies along it now.
  Vec3 axis_T = Vec3::Zero();
  bool has_axis_T = false;
  Quat q_ref = Quat::Identity();  // N-rotation with has_q_ref: the orientation to keep, q_ST
  bool has_q_ref = false;         // else N-rotation keeps the present one
  bool one_way = false;           // line, plane: forward along direction_S only
  bool has_end = false;           // line, plane: no travel along direction_S past p_SE
  Vec3 p_SE = Vec3::Zero();       // end point [m]
  double stiffness = 0.0;         // [N/m] or [N m/rad]; 0: the scene's own
  bool approach = false;          // position tools: the arm goes there, however far it is
};

// True when it brings an orientation to where the call says, instead of keeping what it finds.
inline bool has_reference(const ToolCall& call) noexcept {
  return (call.kind == ToolKind::kNRotation && call.has_q_ref) ||
         (call.kind == ToolKind::kFRotation && call.has_axis && call.has_axis_T);
}

// A scene's tool that is called by its name.
struct NamedTool {
  std::string name;  // 1 to 47 letters, digits, '-' and '_'; one of its kind in the scene
  ToolCall call;
};

// kNone when the call can be anchored; else why not. With at_present the end point is not compared
// with the start: the caller that knows the tip does so by the two below. Real-time safe.
Reason check(const ToolCall& call) noexcept;

// True when the call has an end point that leaves nothing to travel along direction_S from p_SA.
// Real-time safe.
bool end_behind_start(const ToolCall& call, const Vec3& p_SA) noexcept;

// True when its end point is kFarthest or more from p_SA, which no datagram carries. Real-time
// safe.
bool end_too_far(const ToolCall& call, const Vec3& p_SA) noexcept;

}  // namespace handrail
