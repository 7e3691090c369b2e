#include "server/control/guard.h"

#include <algorithm>
#include <cmath>

namespace handrail {
double longest_stoppable(double room, double a) noexcept {
  if (room <= a) return std::max(room, 0.0);
  return std::max(a, -0.5 * a + std::sqrt(2.0 * a * room));
}

double StepBox::largest_share(const JointVector& from, const JointVector& to) const noexcept {
  double share = 1.0;
  for (int i = 0; i < kJoints; ++i) {
    const double d = to[i] - from[i];
    if (d > 0.0 && from[i] + d > high[i]) share = std::min(share, (high[i] - from[i]) / d);
    if (d < 0.0 && from[i] + d < low[i]) share = std::min(share, (low[i] - from[i]) / d);
  }
  return std::clamp(share, 0.0, 1.0);
}

StepBox step_box(const JointLimits& limits, const JointVector& q, const JointVector& last,
                 double dt, double margin, double reserve) noexcept {
  StepBox box;
  for (int i = 0; i < kJoints; ++i) {
    const double v = margin * limits.max_speed[i] * dt;
    const double a = margin * limits.max_acceleration[i] * dt * dt;
    const double full = limits.max_acceleration[i] * dt * dt;
    const double stop = reserve * full;
    box.brake[i] = last[i] > 0.0 ? std::max(last[i] - full, 0.0) : std::min(last[i] + full, 0.0);
    // Range and speed yield to braking: nothing can slow a joint faster than its brake.
    box.high[i] = std::max(
        {box.brake[i], std::min({last[i] + a, v, longest_stoppable(limits.upper[i] - q[i], stop)})});
    box.low[i] = std::min(
        {box.brake[i], std::max({last[i] - a, -v, -longest_stoppable(q[i] - limits.lower[i], stop)})});
  }
  return box;
}

Guarded guard(const JointLimits& limits, const JointVector& q, const JointVector& last,
              const JointVector& q_wanted, double dt) noexcept {
  const StepBox box = step_box(limits, q, last, dt, 1.0, 1.0);
  const JointVector wanted = q_wanted - q;
  if (box.contains(wanted)) return {q_wanted, Reason::kNone};
  if (!wanted.allFinite()) return {q + box.brake, Reason::kGuard};
  return {q + box.brake + box.largest_share(box.brake, wanted) * (wanted - box.brake),
          Reason::kGuard};
}

}  // namespace handrail
