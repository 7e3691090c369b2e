#include "server/lab/faults/audit/joint_audit.h"

#include <algorithm>
#include <cmath>

#include "server/motion/jerk_law.h"

namespace handrail {
namespace {

constexpr double kJointRounding = 1e-9;  // of a limit
constexpr double kStandingStep = 1e-12;  // a smaller step is none [rad]

void add(BreachCounts& breaches, Breach kind) { ++breaches[static_cast<std::size_t>(kind)]; }

}  // namespace

const char* name_of(Breach breach) noexcept {
  switch (breach) {
    case Breach::kNotFinite: return "not finite";
    case Breach::kRange: return "joint range";
    case Breach::kWorkspace: return "outside the workspace";
    case Breach::kSpeed: return "joint speed";
    case Breach::kAcceleration: return "joint acceleration";
    case Breach::kJerk: return "joint jerk";
    case Breach::kUnled: return "moved without being led";
    case Breach::kLateStop: return "stopped late";
    case Breach::kUnasked: return "went where nobody asked";
    case Breach::kOffTool: return "off the tool";
    case Breach::kForce: return "force on the hand";
    case Breach::kBackward: return "applied backward";
    case Breach::kCount: break;
  }
  return "unknown";
}

JointAudit::JointAudit(const AuditLimits& limits) noexcept
    : limits_(limits), dt_(to_seconds(limits.period)) {}

bool JointAudit::commanded(const JointVector& q, BreachCounts& breaches) noexcept {
  if (!q.allFinite()) {
    add(breaches, Breach::kNotFinite);
    return false;
  }
  if (!placed_) q_ = q;
  placed_ = true;
  const JointVector step = q - q_;
  const JointVector change = step - step_;
  const JointVector jolt = change - change_;
  q_ = q;
  step_ = step;
  change_ = change;
  moving_ = step.cwiseAbs().maxCoeff() > kStandingStep;
  at_rest_ = !moving_ && change.cwiseAbs().maxCoeff() <= kStandingStep;
  tip_ = forward(limits_.arm, q).p;
  const JointLimits& joints = limits_.joints;
  const double v = (step.array().abs() / (joints.max_speed.array() * dt_)).maxCoeff();
  const double a =
      (change.array().abs() / (joints.max_acceleration.array() * dt_ * dt_)).maxCoeff();
  const double j = (jolt.array().abs() / (limits_.max_jerk.array() * dt_ * dt_ * dt_)).maxCoeff();
  speed_ = std::max(speed_, v);
  acceleration_ = std::max(acceleration_, a);
  jerk_ = std::max(jerk_, j);
  if (v > 1.0 + kJointRounding) add(breaches, Breach::kSpeed);
  if (a > 1.0 + kJointRounding) add(breaches, Breach::kAcceleration);
  if (j > 1.0 + kJointRounding) add(breaches, Breach::kJerk);
  const double inside = std::min((q - joints.lower).minCoeff(), (joints.upper - q).minCoeff());
  if (inside < -kJointRounding) add(breaches, Breach::kRange);
  const double room = std::min((tip_ - limits_.low).minCoeff(), (limits_.high - tip_).minCoeff());
  if (room < -kJointRounding) add(breaches, Breach::kWorkspace);
  return true;
}

double JointAudit::time_to_stop() const noexcept {
  double longest = 0.0;
  for (int i = 0; i < kJoints; ++i) {
    const double a = limits_.joints.max_acceleration[i];
    const double bend = std::max(a / limits_.max_jerk[i], 2.0 * dt_);
    longest = std::max(longest, std::abs(step_[i]) / dt_ / a + 2.5 * bend);
  }
  return longest;
}

double JointAudit::way_of_joints() const noexcept {
  constexpr int kLongest = 100;     // cycles
  constexpr double kSoftest = 0.7;  // of the limits; softer no stop keeps its bound
  JointVector q = q_, step = step_, change = change_;
  double way = 0.0;
  for (int k = 0; k < kLongest && !(step.isZero(0.0) && change.isZero(0.0)); ++k) {
    for (int i = 0; i < kJoints; ++i) {
      const AxisLimits axis{limits_.joints.max_speed[i] * dt_,
                            kSoftest * limits_.joints.max_acceleration[i] * dt_ * dt_,
                            kSoftest * limits_.max_jerk[i] * dt_ * dt_ * dt_};
      change[i] = stop_change(axis, step[i], change[i]);
      step[i] += change[i];
      q[i] += step[i];
    }
    way = std::max(way, (forward(limits_.arm, q).p - tip_).norm());
  }
  return way;
}

}  // namespace handrail
