#include "server/model/tool_call.h"

namespace handrail {
namespace {

// Shorter vectors give no direction; longer ones could overflow when squared.
constexpr double kShortest = 1e-9;
constexpr double kLongest = 1e9;
// Least travel worth an end point [m].
constexpr double kLeastTravel = 1e-6;

bool is_usable(const Vec3& v) noexcept {
  return is_finite(v) && v.cwiseAbs().maxCoeff() <= kLongest;
}
bool is_zero(const Vec3& v) noexcept { return v.norm() < kShortest; }

Reason check_directions(const ToolCall& call) noexcept {
  switch (call.kind) {
    case ToolKind::kLine:
      return is_zero(call.direction_S) ? Reason::kToolDirectionZero : Reason::kNone;
    case ToolKind::kPlane: {
      if (is_zero(call.normal_S)) return Reason::kToolDirectionZero;
      const bool needs_direction = call.one_way || call.has_end;
      if (is_zero(call.direction_S)) {
        return needs_direction ? Reason::kToolDirectionZero : Reason::kNone;
      }
      // Forward must have a share within the plane.
      const Vec3 across = call.normal_S.normalized().cross(call.direction_S.normalized());
      return across.norm() < 1e-6 ? Reason::kToolDirectionZero : Reason::kNone;
    }
    case ToolKind::kFRotation: {
      const bool zero =
          (call.has_axis && is_zero(call.axis_S)) || (call.has_axis_T && is_zero(call.axis_T));
      return zero ? Reason::kToolDirectionZero : Reason::kNone;
    }
    case ToolKind::kPoint:
    case ToolKind::kNRotation: return Reason::kNone;
    case ToolKind::kNone: break;
  }
  return Reason::kNoSuchTool;
}

}  // namespace

bool end_behind_start(const ToolCall& call, const Vec3& p_SA) noexcept {
  if (!call.has_end || (call.kind != ToolKind::kLine && call.kind != ToolKind::kPlane))
    return false;
  Vec3 forward = call.direction_S.normalized();
  if (call.kind == ToolKind::kPlane) {
    const Vec3 n = call.normal_S.normalized();
    forward = (forward - n * n.dot(forward)).normalized();
  }
  return !(forward.dot(call.p_SE - p_SA) > kLeastTravel);
}

bool end_too_far(const ToolCall& call, const Vec3& p_SA) noexcept {
  return call.has_end && !((call.p_SE - p_SA).norm() < kFarthest);
}

Reason check(const ToolCall& call) noexcept {
  for (const Vec3* v : {&call.direction_S, &call.normal_S, &call.axis_S, &call.axis_T}) {
    if (!is_usable(*v)) return Reason::kToolValueInvalid;
  }
  if (!is_place(call.p_SA) || !is_place(call.p_SE)) return Reason::kToolValueInvalid;
  if (call.has_q_ref && !(is_finite(call.q_ref) && is_unit(call.q_ref))) {
    return Reason::kToolValueInvalid;
  }
  if (!std::isfinite(call.stiffness) || call.stiffness < 0.0) return Reason::kToolValueInvalid;
  const Reason direction = check_directions(call);
  if (direction != Reason::kNone) return direction;
  if (call.at_present) return Reason::kNone;
  if (end_behind_start(call, call.p_SA)) return Reason::kToolEndBehindStart;
  if (end_too_far(call, call.p_SA)) return Reason::kToolValueInvalid;
  return Reason::kNone;
}

}  // namespace handrail
