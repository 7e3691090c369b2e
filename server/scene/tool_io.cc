#include "server/scene/tool_io.h"

#include <cmath>

#include "server/base/plain_text.h"
#include "server/base/units.h"
#include "server/model/linear_task.h"
#include "server/scene/field_check.h"
#include "server/scene/numbers.h"

namespace handrail {
namespace {

ToolKind kind_of(pb::Tool::Kind kind) {
  switch (kind) {
    case pb::Tool::POINT: return ToolKind::kPoint;
    case pb::Tool::LINE: return ToolKind::kLine;
    case pb::Tool::PLANE: return ToolKind::kPlane;
    case pb::Tool::N_ROTATION: return ToolKind::kNRotation;
    case pb::Tool::F_ROTATION: return ToolKind::kFRotation;
  }
  return ToolKind::kNone;
}

// A value the kind would ignore is more likely a mistake than a wish.
Problem check_meaning(const pb::Tool& t, ToolKind kind) {
  const bool line = kind == ToolKind::kLine, plane = kind == ToolKind::kPlane;
  const struct {
    const char* field;
    bool given;
    bool meant;
  } uses[] = {
      {"at_mm", t.at_mm_size() > 0, is_position_tool(kind)},
      {"direction", t.direction_size() > 0, line || plane},
      {"normal", t.normal_size() > 0, plane},
      {"axis", t.axis_size() > 0, kind == ToolKind::kFRotation},
      {"end_mm", t.end_mm_size() > 0, line || plane},
      {"one_way", t.one_way(), line || plane},
      {"turn_deg", t.turn_deg_size() > 0, kind == ToolKind::kNRotation},
      {"tip_axis", t.tip_axis_size() > 0, kind == ToolKind::kFRotation},
      {"stiffness_n_mm", t.stiffness_n_mm() > 0.0, is_position_tool(kind)},
  };
  for (const auto& use : uses) {
    if (!use.given || use.meant) continue;
    return FieldProblem{use.field, "has no meaning for " + pb::Tool::Kind_Name(t.kind())};
  }
  return std::nullopt;
}

Problem check_given(const pb::Tool& t, ToolKind kind) {
  const bool line = kind == ToolKind::kLine, plane = kind == ToolKind::kPlane;
  const bool along = t.direction_size() != 0, across = t.normal_size() != 0;
  const struct {
    const char* field;
    bool lacks;
    const char* text;
  } wants[] = {
      {"direction", line && !along, "missing, but a LINE needs it"},
      {"normal", plane && !across, "missing, but a PLANE needs it"},
      {"one_way", plane && !along && t.one_way(), "needs a direction within the PLANE"},
      {"end_mm", plane && !along && t.end_mm_size() > 0, "needs a direction within the PLANE"},
  };
  for (const auto& want : wants) {
    if (want.lacks) return FieldProblem{want.field, want.text};
  }
  return std::nullopt;
}

// Where the tip of N-rotation's reference points.
Problem reference_from(const pb::Tool& tool, ToolCall& out) {
  out.has_q_ref = tool.turn_deg_size() > 0;
  if (!out.has_q_ref) return std::nullopt;
  const Vec3 turn = vector_of(tool.turn_deg());
  constexpr double kHalfTurn = 180.0;  // [deg]; more is the other way round
  if (turn.norm() > kHalfTurn * (1.0 + 1e-12)) {
    return FieldProblem{"turn_deg", number_text(std::round(turn.norm() * 10.0) / 10.0) +
                                        " deg long, expected at most " + number_text(kHalfTurn)};
  }
  out.q_ref = (rotation_exp(turn * kDeg) * LinearTask().q_first).normalized();
  return std::nullopt;
}

// Names the field behind what the call's own validator refused.
FieldProblem blame(Reason reason, const ToolCall& call) {
  if (reason == Reason::kToolEndBehindStart) return {"end_mm", describe(reason)};
  if (!call.at_present && end_too_far(call, call.p_SA)) {
    const double tenths = std::round((call.p_SE - call.p_SA).norm() / kMm * 10.0);
    return {"end_mm", number_text(tenths / 10.0) + " mm from at_mm, expected less than " +
                          number_text(kFarthest / kMm)};
  }
  if (reason != Reason::kToolDirectionZero) return {"kind", describe(reason)};
  if (call.kind == ToolKind::kFRotation) {
    const bool own = call.has_axis_T && call.axis_T.norm() < 1e-9;
    return {own ? "tip_axis" : "axis", describe(reason)};
  }
  if (call.kind != ToolKind::kPlane) return {"direction", describe(reason)};
  if (call.normal_S.isZero(1e-9)) return {"normal", describe(reason)};
  if (call.direction_S.isZero(1e-9)) return {"direction", describe(reason)};
  return {"direction", "along the normal, expected one within the plane"};
}

}  // namespace

Problem tool_call_from(const pb::Tool& tool, ToolCall& call) {
  if (Problem p = check_fields(tool)) return p;
  ToolCall out;
  out.kind = kind_of(tool.kind());
  if (Problem p = check_meaning(tool, out.kind)) return p;
  if (Problem p = check_given(tool, out.kind)) return p;
  out.at_present = tool.at_mm_size() == 0;
  out.p_SA = vector_of(tool.at_mm()) * kMm;
  out.direction_S = vector_of(tool.direction());
  out.normal_S = vector_of(tool.normal());
  out.has_axis = tool.axis_size() > 0;
  out.axis_S = vector_of(tool.axis());
  out.has_axis_T = tool.tip_axis_size() > 0;
  out.axis_T = vector_of(tool.tip_axis());
  if (Problem p = reference_from(tool, out)) return p;
  out.one_way = tool.one_way();
  out.has_end = tool.end_mm_size() > 0;
  out.p_SE = vector_of(tool.end_mm()) * kMm;
  out.stiffness = tool.stiffness_n_mm() * kNewtonPerMm;
  // A direction given as zero means nothing to `check`, but is never what was wanted.
  const bool zero_direction = tool.direction_size() > 0 && out.direction_S.norm() < 1e-9;
  if (zero_direction) return FieldProblem{"direction", describe(Reason::kToolDirectionZero)};
  const Reason reason = check(out);
  if (reason != Reason::kNone) return blame(reason, out);
  call = out;
  return std::nullopt;
}

}  // namespace handrail
