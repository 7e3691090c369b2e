#include "server/lab/sequences/tool_draw.h"

namespace handrail {
namespace {

// A direction anywhere, or by a hair beside an axis of the base.
Vec3 draw_direction(Draw& draw) {
  if (draw.chance(0.8)) return draw.unit();
  return Vec3::Unit(draw.below(3)) + 1e-9 * draw.unit();
}

void draw_position_tool(Draw& draw, const Pose& command, ToolCall& call) {
  call.at_present = draw.chance(0.4);
  call.p_SA = command.p + draw.between(0.0, kFurthestAnchor) * draw.unit();
  call.normal_S = draw_direction(draw);
  if (call.kind == ToolKind::kLine || draw.chance(0.5)) call.direction_S = draw_direction(draw);
  call.one_way = draw.chance(0.4) && !call.direction_S.isZero();
  call.has_end = draw.chance(0.3) && !call.direction_S.isZero();
  const Vec3 start = call.at_present ? command.p : call.p_SA;
  call.p_SE = start + draw.between(0.001, 0.1) * call.direction_S;
  call.approach = draw.chance(0.25);
  if (draw.chance(0.5)) call.stiffness = draw.between(10.0, kStiffestTool);
}

void draw_orientation_tool(Draw& draw, const Pose& command, ToolCall& call) {
  call.has_axis = draw.chance(0.6);
  // The tip's own axis and up to half a turn from it, as often near either as in between.
  const double turn = draw.chance(0.5)   ? draw.between(0.0, std::numbers::pi)
                      : draw.chance(0.5) ? 1e-9
                                         : std::numbers::pi - 1e-9;
  call.axis_S = rotation_exp(turn * draw.unit()) * (command.q * Vec3::UnitZ());
  if (draw.chance(0.5)) call.stiffness = draw.between(0.01, 3.0);
}

HapticOrder plain_order(OrderKind kind) {
  HapticOrder out;
  out.kind = kind;
  return out;
}

}  // namespace

ToolCall draw_tool(Draw& draw, const Pose& command) {
  ToolCall call;
  call.kind = static_cast<ToolKind>(1 + draw.below(5));
  if (is_position_tool(call.kind)) {
    draw_position_tool(draw, command, call);
  } else {
    draw_orientation_tool(draw, command, call);
  }
  return call;
}

HapticOrder draw_order(Draw& draw, SessionState session, const Pose& command) {
  if (session == SessionState::kFault) return plain_order(OrderKind::kReset);
  if (session == SessionState::kOff) {
    return plain_order(draw.chance(0.9) ? OrderKind::kEngage : OrderKind::kReset);
  }
  HapticOrder out;
  const double which = draw.between(0.0, 1.0);
  if (which < 0.65) {
    out.kind = OrderKind::kTool;
    out.tool = draw_tool(draw, command);
  } else if (which < 0.80) {
    out.kind = OrderKind::kToolOff;
    out.drop_position = draw.chance(0.6);
    out.drop_orientation = draw.chance(0.6);
  } else if (which < 0.97) {
    out.kind = draw.chance(0.4) ? OrderKind::kClutchOn : OrderKind::kClutchOff;
  } else {
    out.kind = draw.chance(0.7) ? OrderKind::kDisengage : OrderKind::kStop;
  }
  return out;
}

}  // namespace handrail
