#include "server/motion/joint_step.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/kinematics/box_solve.h"

namespace handrail {
StepBox::StepBox(const PlanLimits& limits, const GuardState& joints) noexcept {
  for (int i = 0; i < kJoints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const AxisLimits& l = limits.axis[k];
    const AxisState s{joints.q[i], joints.step[i], joints.change[i]};
    double most = fastest_change(l, s.v, s.a), least = -fastest_change(l, -s.v, -s.a);
    const double top = limits.guard.upper[i] - kTiny.past;
    const double end = limits.guard.lower[i] + kTiny.past;
    const double plenty = limits.guard.plenty[i] + limits.speed[i];
    // The guard's own limits too: its bound on reach is not the larger for smaller ones.
    const AxisLimits& g = limits.guard.axis[k];
    if (top - s.x < plenty) most = std::min(track_change(l, s, top), track_change(g, s, top));
    if (s.x - end < plenty) least = std::max(track_change(l, s, end), track_change(g, s, end));
    low[i] = s.v + std::min(most, least);
    high[i] = s.v + std::max(most, least);
  }
}

bool in_box(const PlanLimits& limits, const GuardState& joints, const JointVector& q) noexcept {
  const JointVector step = q - joints.q;
  return limits.planned.plainly_hold(q, step, step - joints.step, joints.change) ||
         StepBox(limits, joints).holds(step);
}

JointVector own_steps(const PlanLimits& limits, const GuardState& joints, const JointVector& there,
                      double share) noexcept {
  const JointVector way = (there - joints.q).cwiseAbs();
  const double longest =
      std::max(way.cwiseQuotient(limits.speed).maxCoeff(), kTiny.share);  // [cycles]
  JointVector steps;
  for (int i = 0; i < kJoints; ++i) {
    AxisLimits l = limits.axis[static_cast<std::size_t>(i)];
    l.speed *= share * std::max(way[i] / (longest * l.speed), kTiny.share);
    const AxisState s{joints.q[i], joints.step[i], joints.change[i]};
    steps[i] = s.v + track_change(l, s, there[i]);
  }
  return steps;
}

JointVector step_in_box(const PlanLimits& limits, const StepBox& box,
                        const Eigen::Matrix<double, 3, kJoints>& J, const JointVector& q,
                        const Vec3& p, const JointVector& own) noexcept {
  const JointVector x = own.cwiseMax(box.low).cwiseMin(box.high);
  using Matrix = Eigen::Matrix<double, kJoints, kJoints>;
  const Matrix H = kMotion.own_way * Matrix::Identity() + J.transpose() * J;
  const JointVector g = J.transpose() * (p - forward(limits.guard.arm, q + x).p);
  return x + solve_in_box<kJoints>(H, g, box.low - x, box.high - x, limits.acceleration);
}

bool solve_near(const ArmGeometry& arm, const Pose& X, const JointVector& seed,
                JointVector& q) noexcept {
  if (inverse_near(arm, X, seed, q) != InverseStatus::kOk) return false;
  JointVector flipped = q;
  flipped[4] = -q[4];
  for (const int i : {3, 5}) {
    flipped[i] += q[i] > seed[i] ? -std::numbers::pi : std::numbers::pi;
  }
  if ((flipped - seed).cwiseAbs().maxCoeff() < (q - seed).cwiseAbs().maxCoeff()) q = flipped;
  return true;
}

}  // namespace handrail
