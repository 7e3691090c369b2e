#include "client/experiment/way_to_a.h"

namespace handrail {
namespace {

pb::Request to_tool(const char* name, bool approach) {
  pb::Request request;
  request.set_named_tool(name);
  if (approach) request.set_approach(true);
  return request;
}

pb::Request clutch_order(bool closed) {
  pb::Request request;
  request.set_clutch(closed);
  return request;
}

pb::Request no_tools() {
  pb::Request request;
  request.mutable_tool_off();
  return request;
}

pb::Request grip_order(bool closed) {
  pb::Request request;
  request.set_grip(closed);
  return request;
}

}  // namespace

std::optional<pb::Request> order_to_a(const StartSight& now, const Pose& X_SA) {
  if (!now.drives) return std::nullopt;
  const bool near = (now.X_ST.p - X_SA.p).norm() <= kNearA;
  const bool upright = angle_between(now.X_ST.q, X_SA.q) <= kNearUpright;
  if (near && upright && !now.turning) {
    if (!now.clutched) return clutch_order(true);
    if (now.tool) return no_tools();
    if (now.gripper && !now.closed) return grip_order(true);
    return std::nullopt;
  }
  if (now.closed && !now.at_a) return grip_order(false);
  if (now.clutched) return clutch_order(false);
  if (!now.at_a) return to_tool("at-A", true);
  if (near && !now.down) return to_tool("down", false);
  return std::nullopt;
}

}  // namespace handrail
