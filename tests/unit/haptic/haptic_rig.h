// A master's step with a slave played beside it, for tests: ticks of 1 ms, a slave that engages and
// stands where it was told, and a watch on the force.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>

#include "server/haptic/haptic_step.h"

namespace handrail::test {

class HapticRig {
 public:
  HapticRig() {
    settings.mapping.scale = 2.0;
    in.hand.valid = true;
    in.hand.X_MH.p = Vec3(0.01, -0.02, 0.03);
    in.hand.X_MH.q = rotation_exp({0.3, -0.2, 0.5});
    in.slave.X_ST.p = Vec3(0.35, 0.05, 0.43);
    in.slave.X_ST.q = rotation_exp({0.1, 3.0, 0.2});
    in.slave.X_ST_command = in.slave.X_ST;
    in.slave.has_pose = true;
    in.slave_known = true;
    in.slave_age = 0;
  }

  // One tick with what `in` says; the order is for this tick only.
  void tick() {
    const Vec3 before = out.f_H_M.force;
    const Vec3 hand_before = state->hand.X_MH.p;
    haptic_step(settings, in, kTick, *state, out);
    in.order = HapticOrder();
    force_step = (out.f_H_M.force - before).norm();
    hand_step = (state->hand.X_MH.p - hand_before).norm();
    most_force = std::max(most_force, out.f_H_M.force.norm());
    finite = finite && is_finite(out.f_H_M) && is_finite(out.link.X_SU) &&
             is_unit(out.link.X_SU.q) && is_finite(out.shares.tool) &&
             is_finite(out.shares.spring) && is_finite(out.shares.limited);
    share_error = std::max(
        share_error,
        (out.shares.tool + out.shares.spring + out.shares.limited - out.f_H_M.force).norm());
    if (play_slave) this->slave();
  }
  void ticks(int n) {
    for (int i = 0; i < n; ++i) tick();
  }

  // Gives an order, ticks once and returns the master's answer.
  Reason order(OrderKind kind) {
    in.order.kind = kind;
    tick();
    return out.order_result;
  }
  Reason call(const ToolCall& tool) {
    in.order.tool = tool;
    return order(OrderKind::kTool);
  }
  Reason drop(bool position, bool orientation) {
    in.order.drop_position = position;
    in.order.drop_orientation = orientation;
    return order(OrderKind::kToolOff);
  }

  // Orders and plays the slave until both are engaged.
  void engage() {
    order(OrderKind::kEngage);
    for (int i = 0; i < 5; ++i) tick();
  }

  const Pose& command() const { return out.link.X_SU; }
  SessionState session() const { return out.link.state; }

  static constexpr double kTick = 1e-3;

  HapticSettings settings;
  HapticInput in;
  std::unique_ptr<HapticState> state = std::make_unique<HapticState>();
  HapticOutput out;
  bool play_slave = true;    // the slave answers each tick
  bool spring_slack = true;  // the arm stands exactly where it was told: no spring
  double force_step = 0.0;   // of the last tick [N]
  double hand_step = 0.0;    // of the last tick [m]
  double most_force = 0.0;   // [N]
  double share_error = 0.0;  // greatest sum of shares minus force [N]
  bool finite = true;

 private:
  void slave() {
    const MasterState& link = out.link;
    in.slave.engagement_epoch = link.engagement_epoch;
    if (in.slave.state == SessionState::kFault) return;
    if (link.desired == Desired::kOff || link.state == SessionState::kOff ||
        link.state == SessionState::kFault) {
      in.slave.state = SessionState::kOff;
    } else if (link.state == SessionState::kAligning) {
      in.slave.state = link.has_command && (link.X_SU.p - in.slave.X_ST_command.p).norm() < 1e-9
                           ? SessionState::kEngaged
                           : SessionState::kAligning;
    }
    if (link.state == SessionState::kEngaged || link.state == SessionState::kClutched) {
      in.slave.X_ST_command = link.X_SU;
      if (spring_slack) in.slave.X_ST = link.X_SU;
    }
  }
};

inline ToolCall call_of(ToolKind kind) {
  ToolCall call;
  call.kind = kind;
  return call;
}
inline ToolCall line_call(const Vec3& direction, bool one_way = false) {
  ToolCall call = call_of(ToolKind::kLine);
  call.direction_S = direction;
  call.one_way = one_way;
  return call;
}
inline ToolCall plane_call(const Vec3& normal) {
  ToolCall call = call_of(ToolKind::kPlane);
  call.normal_S = normal;
  return call;
}
inline ToolCall at(ToolCall call, const Vec3& p_SA) {
  call.at_present = false;
  call.p_SA = p_SA;
  return call;
}

// A hand that wanders at about `speed` [m/s] and `turning` [rad/s], at times at thrice that.
struct Wander {
  Vec3 v = Vec3::Zero();  // [m/s]
  Vec3 w = Vec3::Zero();  // [rad/s]

  template <typename Dice>
  void move(Dice& dice, double speed, double turning, double dt, Pose& X) {
    v += 0.02 * (dice.within(10.0 * speed) - v);
    w += 0.02 * (dice.within(10.0 * turning) - w);
    X.p += dt * v;
    X.q = (rotation_exp(dt * w) * X.q).normalized();
  }
};

}  // namespace handrail::test
