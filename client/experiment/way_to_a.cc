#include "client/experiment/way_to_a.h"

#include "server/base/units.h"
#include "server/model/linear_task.h"

namespace handrail {
namespace {

// A status rounds nothing, an order's millimetres do, a little.
constexpr double kSamePlace = 1e-5;  // [m]
constexpr double kSameTurn = 1e-4;   // [rad]

pb::Request go_to(const Vec3& p_S) {
  pb::Request request;
  pb::Tool& tool = *request.mutable_tool();
  tool.set_kind(pb::Tool::POINT);
  for (const double value : p_S) tool.add_at_mm(value / kMm);
  request.set_approach(true);
  return request;
}

pb::Request turn_to(const Quat& q_ST) {
  pb::Request request;
  pb::Tool& tool = *request.mutable_tool();
  tool.set_kind(pb::Tool::N_ROTATION);
  // As scene.proto has it: on a tip that points straight down.
  const Quat down = LinearTask().q_first;
  for (const double value : rotation_log(q_ST * down.conjugate())) tool.add_turn_deg(value / kDeg);
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
  const bool goes = now.point && (*now.point - X_SA.p).norm() <= kSamePlace;
  if (now.closed && !goes) return grip_order(false);
  if (now.clutched) return clutch_order(false);
  if (!goes) return go_to(X_SA.p);
  const bool turns = now.kept && angle_between(*now.kept, X_SA.q) <= kSameTurn;
  if (near && !turns) return turn_to(X_SA.q);
  return std::nullopt;
}

}  // namespace handrail
