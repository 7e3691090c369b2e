#include "server/motion/tip_law.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "server/kinematics/jacobian.h"

namespace handrail {
namespace {

using Matrix = Eigen::Matrix<double, 6, 6>;

constexpr double kDamping = 3e-5;     // keeps the inverse bounded at singular poses
constexpr double kTogether = 0.3;     // [s]
constexpr double kLeastTop = 0.02;    // [m/s], [rad/s times kTurnLength]
constexpr double kSpeedShare = 0.95;  // of the joints' speed
constexpr double kMoving = 1e-6;      // [m], [rad times kTurnLength] a cycle
constexpr double kTowards = 1e-9;
// Of the speed along. More across is flown past a target that turns away: measured, 0.1 and 0.2 do
// the same, at 0.5 and 1 a tip at the end of its reach goes 3 and 5 mm further beyond.
constexpr double kAcross = 0.1;

// What is left of `v` beside `e`, and its unit in `axis` if it is worth one.
Vector6 beside(const Vector6& v, const Vector6& e) { return v - e.dot(v) * e; }

Vector6 unit_of(const Vector6& v, double least) {
  const double size = v.norm();
  return size > least ? Vector6(v / size) : Vector6(Vector6::Zero());
}

}  // namespace

TipProposal::TipProposal(const PlanLimits& limits, const TipSpace& space, const TipLaw& law,
                         const TipMotion& from, const Pose& target) noexcept
    : limits_(limits), law_(law) {
  way_ = between(from.X_ST, target);
  const TipJacobian J = tip_jacobian(limits.guard.arm, from.joints.q);
  Matrix both;
  both << J.linear, kTurnLength * J.angular;
  const Eigen::LDLT<Matrix> inverse(both.transpose() * both + kDamping * Matrix::Identity());
  const auto set = [&](const Vector6& way, const Vector6& step, const Vector6& change, Axes& axes) {
    Vector6& along = axes[0].unit;
    Vector6& across = axes[1].unit;
    along = unit_of(way.norm() > kMoving ? way : step, kTowards);
    across = unit_of(beside(step, along), kTowards);
    axes[2].unit = unit_of(beside(beside(change, along), across), kTowards);
    for (Axis& axis : axes) {
      if (axis.unit.isZero(0.0)) continue;
      axis.rate = inverse.solve(both.transpose() * axis.unit).cwiseAbs();
      axis.ahead = axis.unit.dot(way);
      axis.step = axis.unit.dot(step);
      axis.change = axis.unit.dot(change);
    }
    axes[1].ahead = axes[2].ahead = 0.0;
  };
  const auto place = [&](const Vec3& v) { return six({space.along(v), Vec3::Zero()}); };
  const auto turn = [](const Vec3& v) { return six({Vec3::Zero(), v}); };
  set(place(way_.linear), place(from.tip_step.linear), place(from.tip_change.linear), place_);
  set(turn(way_.angular), turn(from.tip_step.angular), turn(from.tip_change.angular), turn_);
  set_top();
}

void TipProposal::set_top() noexcept {
  for (Axis& axis : place_) axis.top = law_.tip_speed * law_.dt;
  // What takes long by its way or by its turn goes both together: the straight way.
  const double cycles = std::max(place_[0].ahead / slowest(place_[0]).value,
                                 turn_[0].ahead / slowest(turn_[0]).value);
  if (cycles * law_.dt < kTogether) return;
  for (Axes* axes : {&place_, &turn_}) {
    Axis& axis = (*axes)[0];
    axis.top = std::min(axis.top, std::max(axis.ahead / cycles, kLeastTop * law_.dt));
  }
}

TipProposal::Weakest TipProposal::slowest(const Axis& axis) const noexcept {
  Weakest out{axis.top, -1};
  for (std::int8_t i = 0; i < kJoints; ++i) {
    const double speed =
        kSpeedShare * limits_.axis[static_cast<std::size_t>(i)].speed / (axis.rate[i] + 1e-12);
    if (speed < out.value) out = {speed, i};
  }
  return out;
}

TipProposal::Weakest TipProposal::weakest(const Axis& axis) const noexcept {
  Weakest out{1e9, -1};
  for (std::int8_t i = 0; i < kJoints; ++i) {
    const double a =
        limits_.axis[static_cast<std::size_t>(i)].acceleration / (axis.rate[i] + 1e-12);
    if (a < out.value) out = {a, i};
  }
  return out;
}

AxisLimits TipProposal::limits_of(const Axis& axis, double share) const noexcept {
  AxisLimits out{law_.speed_share * slowest(axis).value, 1e9, 1e9};
  for (int i = 0; i < kJoints; ++i) {
    const AxisLimits& l = limits_.axis[static_cast<std::size_t>(i)];
    const double rate = axis.rate[i] + 1e-12;
    out.acceleration = std::min(out.acceleration, share * l.acceleration / rate);
    out.jerk = std::min(out.jerk, share * l.jerk / rate);
  }
  return out;
}

Twist TipProposal::change(double place, double turn, double hard, bool faster) const noexcept {
  Vector6 out = Vector6::Zero();
  const auto add = [&](const Axes& axes, double share) {
    for (std::size_t k = 0; k < axes.size(); ++k) {
      const Axis& axis = axes[k];
      if (axis.unit.isZero(0.0)) continue;
      AxisLimits limits = limits_of(axis, share);
      if (k == 0 && !faster && axes[1].step > kAcross * axis.step) {
        limits.speed = std::min(limits.speed, std::max(axis.step, kLeastTop * law_.dt));
      }
      double change = track_change(limits, {0.0, axis.step, axis.change}, axis.ahead, hard);
      // Braking that began with a larger share still does not turn back from what lies ahead.
      if (k == 0 && axis.ahead >= 0.0) change = std::max(change, -std::max(axis.step, 0.0));
      out += change * axis.unit;
    }
  };
  add(place_, place);
  add(turn_, turn);
  return {out.head<3>(), out.tail<3>() / kTurnLength};
}

double TipProposal::cycles(const Axis& axis) const noexcept {
  const double way = std::abs(axis.ahead);
  if (way < kTowards) return 0.0;
  return std::max(way / slowest(axis).value, std::sqrt(way / weakest(axis).value));
}

Verdict TipProposal::limiting() const noexcept {
  const Axis& axis = std::abs(place_[0].ahead) > std::abs(turn_[0].ahead) ? place_[0] : turn_[0];
  constexpr double kNear = 0.9;
  const Weakest top = slowest(axis), weak = weakest(axis);
  if (axis.step > kNear * top.value * law_.speed_share) {
    return {top.joint < 0 ? Reason::kTipSpeed : Reason::kJointSpeed, top.joint};
  }
  const bool hard = std::abs(axis.change) > 0.8 * weak.value;
  return {hard ? Reason::kJointAcceleration : Reason::kJointJerk, weak.joint};
}

}  // namespace handrail
