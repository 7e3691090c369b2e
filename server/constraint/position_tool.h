// Position tools: point, line and plane, with or without direction and end (dissertation 3.2.2).
#pragma once

#include <array>

#include "server/model/tool.h"

namespace handrail {

// How the proxy is found.
enum class GuidanceMethod : std::uint8_t {
  kExact,      // closed form
  kPublished,  // Algorithm 2: steps of delta while the distance shrinks
};

// An allowed set and the proxy in it (the dissertation's nearest tool point, NTP), frame S.
//
// The set is a point, or the span of one or two unit axes through the anchor. Axis 0 is the forward
// direction: travel along it may be one-way, and may end. Each tick the proxy moves from where it
// was toward the hand without leaving the set, so force stays continuous wherever the hand is.
// Every method is real-time safe; `advance` does bounded work.
class PositionTool {
 public:
  // No tool: everything is allowed and the proxy is the hand.
  PositionTool() = default;

  // `tool` has passed its checks: unit directions, a plane's forward direction within the plane.
  // `delta` is the published method's step in S, > 0 [m].
  PositionTool(const ToolDefinition& tool, GuidanceMethod method, double delta) noexcept;

  bool active() const noexcept { return tool_.kind != ToolKind::kNone; }
  const ToolDefinition& definition() const noexcept { return tool_; }

  // Starts tracking at the allowed point nearest to `p_SP`, the proxy so far. On a one-way tool the
  // start is no earlier than `p_SC`, the point already commanded. Returns the proxy [m].
  Vec3 start(const Vec3& p_SP, const Vec3& p_SC) noexcept;

  // Moves the proxy toward the hand `p_SH`; returns it [m].
  Vec3 advance(const Vec3& p_SH) noexcept;

  // Distance of `p` from the set, ignoring direction and end [m]; 0 without a tool.
  double distance(const Vec3& p) const noexcept;

  // Of the vector `v` what points along the set; all of it without a tool.
  Vec3 along(const Vec3& v) const noexcept;

  // Travel of `p` along the forward direction from the anchor [m]; 0 without one.
  double travel(const Vec3& p) const noexcept;

 private:
  double forward_limit(double wanted) const noexcept;
  void advance_by_steps(const Vec3& p_SH) noexcept;
  Vec3 proxy() const noexcept;

  ToolDefinition tool_;
  GuidanceMethod method_ = GuidanceMethod::kExact;
  double delta_ = 1e-4;
  int dimensions_ = 0;
  std::array<Vec3, 2> axis_{Vec3::Zero(), Vec3::Zero()};
  std::array<double, 2> t_{0.0, 0.0};  // the proxy's coordinates along the axes [m]
};

}  // namespace handrail
