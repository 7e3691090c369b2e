#include "server/control/joint_brake.h"

#include <algorithm>

#include <Eigen/LU>

namespace handrail {
namespace {

constexpr double kProbe = 1e-6;        // [rad]
constexpr double kOnLine = 1e-8;       // [m]
constexpr double kNoDirection = 1e-9;  // [m]
constexpr int kIterations = 5;

// dp/dq of the tip at `q` [m/rad].
Eigen::Matrix<double, 3, kJoints> tip_jacobian(const ArmGeometry& arm, const JointVector& q) {
  Eigen::Matrix<double, 3, kJoints> out;
  const Vec3 p = forward(arm, q).p;
  for (int i = 0; i < kJoints; ++i) {
    JointVector probe = q;
    probe[i] += kProbe;
    out.col(i) = (forward(arm, probe).p - p) / kProbe;
  }
  return out;
}

// What of `d` is not along `u`, a unit vector or zero.
Vec3 across(const Vec3& d, const Vec3& u) { return d - d.dot(u) * u; }

}  // namespace

JointVector joint_brake(const MotionSettings& settings, const MotionState& state,
                        const StepBox& box) noexcept {
  const JointVector a = settings.dt * settings.dt * settings.limits.max_acceleration;
  double share = 0.0;
  for (int i = 0; i < kJoints; ++i) {
    const double last = std::abs(state.step[i]);
    if (last > a[i]) share = std::max(share, 1.0 - a[i] / last);
  }
  JointVector step = share * state.step;
  const double length = state.tip_step.linear.norm();
  const Vec3 u = length > kNoDirection ? Vec3(state.tip_step.linear / length) : Vec3(Vec3::Zero());
  const Eigen::Matrix<double, 3, kJoints> J = tip_jacobian(settings.arm, state.q + step);
  JointVector weight = a.cwiseAbs2();
  for (int i = 0; i < kIterations; ++i) {
    const Vec3 off = across(forward(settings.arm, state.q + step).p - state.X_ST.p, u);
    if (off.norm() < kOnLine) break;
    const Eigen::Matrix<double, kJoints, 3> weighted = weight.asDiagonal() * J.transpose();
    step -= weighted * ((J * weighted).inverse() * off);
    if (!step.allFinite()) return box.brake;
    // A joint at its limit stays there; the others make up for it.
    const JointVector inside = step.cwiseMax(box.low).cwiseMin(box.high);
    weight = (inside.array() == step.array()).select(weight, 0.0);
    step = inside;
  }
  return step;
}

}  // namespace handrail
