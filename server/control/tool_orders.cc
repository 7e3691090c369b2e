#include "server/control/tool_orders.h"

namespace handrail {
namespace {

// The hand where the guide works: in S while engaged; without an engagement a tool call has nothing
// to pull, so the command's own pose stands for the hand.
Pose hand_in_slave(const HapticState& s) {
  return s.driving ? s.engagement.to_slave(s.X_MH) : s.X_SU;
}

// Changes the position tool. Where an approach ends, the arm must not go on to where the hand would
// have been; where one begins, the hand goes along.
template <typename Change>
Reason change_position_tool(const HapticSettings& settings, HapticState& s, Change change) {
  Pose X_SH = hand_in_slave(s);
  const bool ended = s.guide.approaching();
  if (ended) X_SH.p = s.X_SU.p;
  const Reason result = change(X_SH);
  if (result != Reason::kNone) return result;
  if (s.guide.approaching()) X_SH.p = s.guide.proxy().p;
  if (ended || s.guide.approaching()) {
    s.engagement = Engagement(settings.mapping, s.X_MH, X_SH);
  }
  return Reason::kNone;
}

}  // namespace

Reason call_tool(const HapticSettings& settings, const ToolCall& call, HapticState& s,
                 double& distance) noexcept {
  if (!is_position_tool(call.kind)) {
    return s.guide.call(settings.guide, call, hand_in_slave(s));
  }
  if (call.approach && !s.driving) {
    return s.session == SessionState::kClutched ? Reason::kClutched : Reason::kDeviceInvalid;
  }
  return change_position_tool(settings, s, [&](const Pose& X_SH) {
    return s.guide.call(settings.guide, call, X_SH, &distance);
  });
}

Reason drop_tools(const HapticSettings& settings, bool position, bool orientation,
                  HapticState& s) noexcept {
  Reason result = Reason::kNoSuchTool;
  if (position) {
    result = change_position_tool(
        settings, s, [&](const Pose& X_SH) { return s.guide.drop_position(settings.guide, X_SH); });
  }
  if (orientation) {
    const Reason second = s.guide.drop_orientation(settings.guide, hand_in_slave(s));
    if (result != Reason::kNone) result = second;
  }
  return result;
}

}  // namespace handrail
