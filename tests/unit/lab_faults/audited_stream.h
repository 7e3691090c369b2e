// A master, a network and joint commands made by hand, cycle by cycle, as an auditor sees them.
#pragma once

#include <algorithm>
#include <cmath>

#include "server/lab/faults/audit/auditor.h"

namespace handrail {

inline constexpr Nanos kCycle = 7'100 * kMicrosecond;
inline const double kDt = to_seconds(kCycle);

inline AuditLimits limits() {
  AuditLimits out;
  out.joints = rv2a_limits();
  out.max_jerk = out.joints.max_acceleration / 0.020;
  return out;
}

// Along x, which J1 turns the tip across.
inline ToolDefinition line_through(const Vec3& p) {
  ToolDefinition tool;
  tool.kind = ToolKind::kLine;
  tool.id = tool.epoch = 1;
  tool.p_SA = p;
  tool.direction_S = Vec3::UnitX();
  return tool;
}

// A master, the network and joint commands as the test wants them.
class Stream {
 public:
  explicit Stream(const AuditLimits& judged = limits()) : auditor(judged) {
    state.desired = Desired::kEngaged;
    state.state = SessionState::kAligning;
    q << 0.0, 0.0, 1.5, 0.0, 1.5, 0.0;
    state.X_SU = forward(limits().arm, q);
    state.has_command = true;
    cycle();
    state.state = SessionState::kEngaged;
    cycle();
  }

  // One controller cycle: seven datagrams arrive unless the link is down, then the command.
  void cycle(double step_of_j1 = 0.0) {
    for (int i = 0; i < 7; ++i) {
      now += kMillisecond;
      auditor.sent(++number, incarnation, state);
      if (link) auditor.delivered({number, Origin::kGenuine, now});
    }
    now += kCycle - 7 * kMillisecond;
    q[0] += step_of_j1;
    auditor.commanded(q, now);
  }

  // Speeds J1 up or down within its limits to `speed` in rad a cycle.
  void change_speed(double speed) {
    const double jerk = 0.9 * limits().max_jerk[0] * kDt * kDt * kDt;
    const double hard = 0.9 * limits().joints.max_acceleration[0] * kDt * kDt;
    const double way = speed - v;
    const int n = static_cast<int>(
        std::ceil(std::max(std::sqrt(std::abs(way) / jerk), std::abs(way) / hard)));
    const double rise = way / (n * n);
    double change = 0.0;
    for (int i = 0; i < 2 * n; ++i) {
      change += i < n ? rise : -rise;
      v += change;
      if (i == 2 * n - 1) v = speed;
      follow();
    }
  }
  void coast(int cycles) {
    for (int i = 0; i < cycles; ++i) follow();
  }

  const AuditReport& report() { return auditor.report(); }

  Auditor auditor;
  MasterState state;
  JointVector q = JointVector::Zero();
  std::uint64_t number = 0;
  std::uint32_t incarnation = 1;
  bool link = true;
  Nanos now = 0;
  double v = 0.0;

 private:
  // The command is ahead of the tip, as far as a stop takes it.
  void follow() {
    JointVector next = q;
    next[0] += 10.0 * v;
    state.X_SU = forward(limits().arm, next);
    cycle(v);
  }
};

}  // namespace handrail
