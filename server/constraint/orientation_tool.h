// Orientation tools: N-rotation and F-rotation (dissertation 3.2.2, equations 3.5 to 3.9).
#pragma once

#include "server/model/tool.h"

namespace handrail {

// The allowed orientations and the proxy among them, q_ST.
//
// N-rotation allows one orientation. F-rotation allows those that keep the tip's axis `axis_T` on
// `normal_S`: the hand's orientation is turned by the smallest rotation that puts the axis back,
// R_v = R_u(phi) R. Angles come from atan2, so rounding never leaves the domain of acos; where u is
// undefined (phi near pi) the previous proxy stays. Real-time safe.
class OrientationTool {
 public:
  // No tool: every orientation is allowed and the proxy is the hand's.
  OrientationTool() = default;
  explicit OrientationTool(const ToolDefinition& tool) noexcept : tool_(tool) {}

  bool active() const noexcept { return tool_.kind != ToolKind::kNone; }
  const ToolDefinition& definition() const noexcept { return tool_; }

  // Starts at the allowed orientation nearest to `q_SP`, the proxy so far; from half a turn off,
  // where each way round is as near, at one of them.
  Quat start(const Quat& q_SP) noexcept;

  // The proxy for the hand's orientation `q_SH`.
  Quat advance(const Quat& q_SH) noexcept;

  // True when the last `advance` left the undefined region around phi = pi and so may have jumped:
  // the caller eases the jump like a tool change.
  bool rejoined() const noexcept { return rejoined_; }

  // Angle between `q` and the nearest allowed orientation [rad]; 0 without a tool.
  double deviation(const Quat& q) const noexcept;

 private:
  ToolDefinition tool_;
  Quat proxy_ = Quat::Identity();
  bool undefined_ = false;
  bool rejoined_ = false;
};

}  // namespace handrail
