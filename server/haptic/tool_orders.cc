#include "server/haptic/tool_orders.h"

namespace handrail {
namespace {

// The hand where the guide works: in S while engaged; without an engagement a tool call has nothing
// to pull, so the command's own pose stands for the hand.
Pose hand_in_slave(const HapticState& s) {
  return s.command.driving ? s.command.engagement.to_slave(s.hand.X_MH) : s.command.X_SU;
}

// Changes a tool, and latches the hand where the guide takes it to be from then on.
template <typename Change>
Reason change_tool(const HapticSettings& settings, HapticState& s, Change change) {
  const Pose before = hand_in_slave(s);
  Pose X_SH = before;
  const Reason result = change(X_SH);
  const bool latched = X_SH.p != before.p || X_SH.q.coeffs() != before.q.coeffs();
  if (latched) s.command.engagement = Engagement(settings.mapping, s.hand.X_MH, X_SH);
  return result;
}

}  // namespace

Reason call_tool(const HapticSettings& settings, const ToolCall& call, const Vec3& p_ST,
                 HapticState& s, double& distance) noexcept {
  if (!is_position_tool(call.kind)) {
    return change_tool(settings, s, [&](Pose& X_SH) {
      return s.command.guide.call(settings.guide, call, p_ST, X_SH);
    });
  }
  if (call.approach && !s.command.driving) {
    return s.lead.session == SessionState::kClutched ? Reason::kClutched : Reason::kDeviceInvalid;
  }
  return change_tool(settings, s, [&](Pose& X_SH) {
    return s.command.guide.call(settings.guide, call, p_ST, X_SH, &distance);
  });
}

Reason drop_tools(const HapticSettings& settings, bool position, bool orientation,
                  HapticState& s) noexcept {
  Reason result = Reason::kNoSuchTool;
  if (position) {
    result = change_tool(settings, s, [&](Pose& X_SH) {
      return s.command.guide.drop_position(settings.guide, X_SH);
    });
  }
  if (orientation) {
    const Reason second = change_tool(settings, s, [&](Pose& X_SH) {
      return s.command.guide.drop_orientation(settings.guide, X_SH);
    });
    if (result != Reason::kNone) result = second;
  }
  return result;
}

}  // namespace handrail
