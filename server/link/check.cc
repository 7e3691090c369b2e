#include "server/link/check.h"

#include <cmath>

namespace handrail {
namespace {

// The first cause that is not kNone.
template <typename... Causes>
Reject first_of(Causes... causes) {
  Reject found = Reject::kNone;
  ((found == Reject::kNone ? found = causes : found), ...);
  return found;
}

Reject require(bool holds, Reject otherwise) { return holds ? Reject::kNone : otherwise; }

Reject check_position(const Vec3& p) {
  if (!is_finite(p)) return Reject::kNotFinite;
  return require(is_place(p), Reject::kRange);
}

Reject check_rotation(const Quat& q) {
  if (!is_finite(q)) return Reject::kNotFinite;
  return require(is_unit(q, kUnitTolerance), Reject::kRotation);
}

Reject check_pose(const Pose& x) { return first_of(check_position(x.p), check_rotation(x.q)); }

bool is_zero(const Vec3& v) { return v == Vec3::Zero(); }
bool is_unit_vector(const Vec3& v) { return std::abs(v.squaredNorm() - 1.0) < kUnitTolerance; }

Reject check_numbers(const ToolDefinition& tool) {
  const bool finite = is_finite(tool.direction_S) && is_finite(tool.normal_S) &&
                      is_finite(tool.axis_T) && std::isfinite(tool.end) &&
                      std::isfinite(tool.stiffness);
  return first_of(check_pose({tool.p_SA, tool.q_ref}), require(finite, Reject::kNotFinite),
                  require(tool.stiffness >= 0.0, Reject::kRange),
                  require(tool.has_end ? tool.end > 0.0 && tool.end < kFarthest : tool.end == 0.0,
                          Reject::kTool));
}

bool is_bare(const ToolDefinition& tool) {
  return is_zero(tool.p_SA) && is_zero(tool.direction_S) && is_zero(tool.normal_S) &&
         is_zero(tool.axis_T) && tool.q_ref.coeffs() == Quat::Identity().coeffs() &&
         !tool.one_way && !tool.has_end;
}

bool no_tool_consistent(const ToolDefinition& tool) {
  return is_bare(tool) && tool.id == 0 && tool.stiffness == 0.0;
}

bool position_consistent(const ToolDefinition& tool) {
  if (tool.kind == ToolKind::kNone) return no_tool_consistent(tool);
  if (!is_zero(tool.axis_T) || tool.q_ref.coeffs() != Quat::Identity().coeffs()) return false;
  const bool directed = is_unit_vector(tool.direction_S);
  if (!directed && (!is_zero(tool.direction_S) || tool.one_way || tool.has_end)) return false;
  switch (tool.kind) {
    case ToolKind::kPoint: return !directed && is_zero(tool.normal_S);
    case ToolKind::kLine: return directed && is_zero(tool.normal_S);
    case ToolKind::kPlane:
      return is_unit_vector(tool.normal_S) &&
             std::abs(tool.direction_S.dot(tool.normal_S)) < kUnitTolerance;
    default: return false;
  }
}

bool orientation_consistent(const ToolDefinition& tool) {
  if (tool.kind == ToolKind::kNone) return no_tool_consistent(tool);
  ToolDefinition rest = tool;
  rest.normal_S = rest.axis_T = Vec3::Zero();
  rest.q_ref = Quat::Identity();
  if (!is_bare(rest)) return false;
  switch (tool.kind) {
    case ToolKind::kNRotation: return is_zero(tool.normal_S) && is_zero(tool.axis_T);
    case ToolKind::kFRotation:
      return is_unit_vector(tool.normal_S) && is_unit_vector(tool.axis_T) &&
             tool.q_ref.coeffs() == Quat::Identity().coeffs();
    default: return false;
  }
}

bool is_name_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
         c == '_';
}

Reject check_scene(const SceneName& scene) {
  std::size_t length = 0;
  while (length < scene.size() && is_name_character(scene[length])) ++length;
  if (length == scene.size()) return Reject::kScene;
  for (std::size_t i = length; i < scene.size(); ++i) {
    if (scene[i] != '\0') return Reject::kScene;
  }
  return Reject::kNone;
}

template <typename Enum>
Reject check_enum(Enum value) {
  return require(value < Enum::kCount, Reject::kEnum);
}

Reject check_ledger(const FollowLedger& ledger) {
  Reject cause = first_of(require(ledger.off_S.allFinite(), Reject::kNotFinite),
                          require(ledger.joint >= -1 && ledger.joint < kJoints, Reject::kRange));
  for (const Reason why : ledger.why) cause = first_of(cause, check_enum(why));
  return cause;
}

Reject check_surface(const std::optional<Surface>& surface) {
  if (!surface) return Reject::kNone;
  const bool finite =
      is_finite(surface->n_S) && std::isfinite(surface->d) && std::isfinite(surface->stiffness);
  return first_of(
      require(finite, Reject::kNotFinite),
      require(is_unit_vector(surface->n_S) && std::abs(surface->d) <= kFarthestSurface &&
                  surface->stiffness >= kSoftestSurface && surface->stiffness <= kStiffestSurface,
              Reject::kSurface));
}

}  // namespace

Reject check_position_tool(const ToolDefinition& tool) noexcept {
  return first_of(check_numbers(tool), require(position_consistent(tool), Reject::kTool));
}

Reject check_orientation_tool(const ToolDefinition& tool) noexcept {
  return first_of(check_numbers(tool), require(orientation_consistent(tool), Reject::kTool));
}

Reject check(const MasterState& state) noexcept {
  return first_of(check_enum(state.desired), check_enum(state.state), check_enum(state.grip),
                  check_pose(state.X_SU), check_position_tool(state.position_tool),
                  check_orientation_tool(state.orientation_tool), check_scene(state.scene));
}

Reject check(const SlaveState& state) noexcept {
  return first_of(
      check_enum(state.state), check_enum(state.reason), check_enum(state.fault),
      check_enum(state.obstacle), check_enum(state.gripper), check_pose(state.X_ST_command),
      check_pose(state.X_ST),
      require(state.q_measured.allFinite() && is_finite(state.f_E_S), Reject::kNotFinite),
      require(state.oldest_applied >= 0 && state.program.calendar >= 0, Reject::kRange),
      check_ledger(state.ledger), check_surface(state.surface), check_scene(state.scene));
}

}  // namespace handrail
