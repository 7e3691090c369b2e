#include "server/motion/slide.h"

#include <algorithm>

#include "server/kinematics/box_solve.h"
#include "server/motion/place_solver.h"

namespace handrail {
namespace {

using Matrix = Eigen::Matrix<double, kJoints, kJoints>;

constexpr double kGive = 1e-6;        // what a radian off the joints' own way counts [m^2]
constexpr double kOff = 2e-6;         // [m]
constexpr double kOffEnd = 1e-7;      // of a range, so that rounding does not end there [rad]
constexpr double kLeastSpeed = 0.05;  // of a joint's that has little way to go
constexpr int kIterations = 4;
constexpr int kParts = 8;  // of a way, to see how far off it leads

// What each joint may do this cycle [rad].
struct StepBox {
  JointVector low, high;
};

StepBox step_box(const PlanLimits& limits, const GuardState& joints) {
  StepBox box;
  for (int i = 0; i < kJoints; ++i) {
    // The guard's own limits too: its bound on reach is not the larger for smaller ones.
    const AxisLimits& l = limits.axis[static_cast<std::size_t>(i)];
    const AxisLimits& g = limits.guard.axis[static_cast<std::size_t>(i)];
    const AxisState s{joints.q[i], joints.step[i], joints.change[i]};
    const double top = limits.guard.upper[i] - kOffEnd, end = limits.guard.lower[i] + kOffEnd;
    const double up = std::min(track_change(l, s, top), track_change(g, s, top));
    const double down = std::max(track_change(l, s, end), track_change(g, s, end));
    box.low[i] = joints.step[i] + std::min(up, down);
    box.high[i] = joints.step[i] + std::max(up, down);
  }
  return box;
}

// The joints' own steps, each at a speed that brings all there together.
JointVector own_steps(const PlanLimits& limits, const GuardState& joints, const JointVector& there,
                      double speed) {
  double longest = 1e-9;  // in cycles
  for (int i = 0; i < kJoints; ++i) {
    longest = std::max(
        longest, std::abs(there[i] - joints.q[i]) / limits.axis[static_cast<std::size_t>(i)].speed);
  }
  JointVector steps;
  for (int i = 0; i < kJoints; ++i) {
    AxisLimits l = limits.axis[static_cast<std::size_t>(i)];
    const double together = std::abs(there[i] - joints.q[i]) / (longest * l.speed);
    l.speed *= speed * std::max(together, kLeastSpeed);
    const AxisState s{joints.q[i], joints.step[i], joints.change[i]};
    steps[i] = s.v + track_change(l, s, there[i]);
  }
  return steps;
}

}  // namespace

bool slide(const PlanLimits& limits, const TipSpace& space, const TipMotion& from,
           const JointVector& there, const Vec3& p_wanted, double speed, JointVector& q) noexcept {
  const StepBox box = step_box(limits, from.joints);
  JointVector size;
  for (int i = 0; i < kJoints; ++i) {
    size[i] = limits.axis[static_cast<std::size_t>(i)].acceleration;
  }
  const JointVector own =
      own_steps(limits, from.joints, there, speed).cwiseMax(box.low).cwiseMin(box.high);
  const Vec3 p_goal = space.nearest(p_wanted);
  JointVector x = own;
  Vec3 p = forward(limits.guard.arm, from.joints.q + x).p;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const auto J = tip_jacobian(limits.guard.arm, from.joints.q + x).linear;
    const Matrix H = kGive * Matrix::Identity() + J.transpose() * J;
    const JointVector g = kGive * (own - x) + J.transpose() * (p_goal - p);
    x += solve_in_box<kJoints>(H, g, box.low - x, box.high - x, size);
    p = forward(limits.guard.arm, from.joints.q + x).p;
  }
  q = from.joints.q + x;
  if (!q.allFinite() || (p - p_goal).norm() > kOff) return false;
  PlaceSolver(limits, from.joints.q).correct(limits.guard.arm, p_goal, q);
  return true;
}

JointVector own_way(const PlanLimits& limits, const GuardState& joints, const JointVector& there,
                    double speed) noexcept {
  return joints.q + own_steps(limits, joints, there, speed);
}

double own_cycles(const PlanLimits& limits, const JointVector& q,
                  const JointVector& there) noexcept {
  double most = 0.0;
  for (int i = 0; i < kJoints; ++i) {
    const AxisLimits& l = limits.axis[static_cast<std::size_t>(i)];
    const double way = std::abs(there[i] - q[i]);
    most = std::max({most, way / l.speed, std::sqrt(way / l.acceleration)});
  }
  return most;
}

double detour(const ArmGeometry& arm, const JointVector& q, const JointVector& there,
              const Vec3& p) noexcept {
  const auto off = [&](double part) { return (forward(arm, q + part * (there - q)).p - p).norm(); };
  double most = 0.0;
  for (int i = 1; i < kParts; ++i) most = std::max(most, off(static_cast<double>(i) / kParts));
  return most - off(0.0);
}

}  // namespace handrail
