#include "server/motion/tip_law.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace handrail {
namespace {

using Matrix = Eigen::Matrix<double, 6, 6>;

Vector6 six(const Twist& t) {
  Vector6 out;
  out << t.linear, kMotion.turn_length * t.angular;
  return out;
}

// What is left of `v` beside `e`, and its unit in `axis` if it is worth one.
Vector6 beside(const Vector6& v, const Vector6& e) { return v - e.dot(v) * e; }

Vector6 unit_of(const Vector6& v, double least) {
  const double size = v.norm();
  return size > least ? Vector6(v / size) : Vector6(Vector6::Zero());
}

// Solves H x = b for many b: a division a row of the factor, once.
class Inverse {
 public:
  explicit Inverse(const Matrix& H) : factor_(Matrix::Zero()) {
    const Matrix L = Eigen::LLT<Matrix>(H).matrixL();
    for (int i = 0; i < 6; ++i) {
      const double by = 1.0 / L(i, i);
      factor_(i, i) = by;
      for (int j = 0; j < i; ++j) {
        double sum = 0.0;
        for (int k = j; k < i; ++k) sum += L(i, k) * factor_(k, j);
        factor_(i, j) = -by * sum;
      }
    }
  }
  JointVector operator*(const Vector6& b) const {
    return factor_.transpose() * Vector6(factor_ * b);
  }

 private:
  Matrix factor_;  // of L, the inverse
};

// What `taken` leaves of `room`; never nothing, so that the tip can always brake.
JointVector left_of(const PlanLimits& limits, const JointVector& room, const JointVector& taken) {
  return (room - taken).cwiseMax((1.0 - kMotion.law_share) * limits.acceleration);
}

}  // namespace

TipProposal::TipProposal(const PlanLimits& limits, const TipSpace& space, const TipLaw& law,
                         const TipJacobian& J, const TipMotion& from, const Pose& target) noexcept
    : limits_(limits), law_(law) {
  way_ = between(from.X_ST, target);
  Matrix both;
  both << J.linear, kMotion.turn_length * J.angular;
  const Inverse inverse(both.transpose() * both + kMotion.damping * Matrix::Identity());
  const auto set = [&](const Vector6& way, const Vector6& step, const Vector6& change, Axes& axes) {
    Vector6& along = axes[0].unit;
    Vector6& across = axes[1].unit;
    along =
        unit_of(way.norm() > kTiny.coming || step.norm() < kTiny.going ? way : step, kTiny.going);
    across = unit_of(beside(step, along), kTiny.going);
    axes[2].unit = unit_of(beside(beside(change, along), across), kTiny.going);
    for (Axis& axis : axes) {
      if (axis.unit.isZero(0.0)) continue;
      axis.rate = (inverse * (both.transpose() * axis.unit)).cwiseAbs();
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
  // What the joints accelerate though the tip does not: the curve of its straight way.
  const Vector6 change = six(from.tip_change);
  const JointVector curve = (from.joints.change - inverse * (both.transpose() * change)).cwiseAbs();
  room_ = left_of(limits, kMotion.law_share * limits.acceleration, curve);
  set_top();
}

void TipProposal::set_top() noexcept {
  for (Axis& axis : place_) axis.top = law_.tip_speed * law_.dt;
  // What takes long by its way or by its turn goes both together: the straight way.
  const double cycles = std::max(place_[0].ahead / slowest(place_[0]).value,
                                 turn_[0].ahead / slowest(turn_[0]).value);
  if (cycles * law_.dt >= kMotion.together) {
    for (Axes* axes : {&place_, &turn_}) {
      Axis& axis = (*axes)[0];
      axis.top = std::min(axis.top, std::max(axis.ahead / cycles, kMotion.slow * law_.dt));
    }
  }
  // A stop takes place and turn to rest as one: what lies ahead lasts for a stop of the turn.
  const Axis& turn = turn_[0];
  if (turn.step <= 0.0) return;
  const double reach =
      turn.step + stop_reach(limits_of(turn, limits_.acceleration, 1.0), turn.step, turn.change);
  Axis& place = place_[0];
  place.top =
      std::min(place.top, (std::max(place.ahead, kTiny.going) + law_.past) * turn.step / reach);
}

TipProposal::Weakest TipProposal::slowest(const Axis& axis) const noexcept {
  Weakest out{axis.top, -1};
  for (std::int8_t i = 0; i < kJoints; ++i) {
    const double speed = kMotion.plan_share * limits_.speed[i] / (axis.rate[i] + kTiny.joint);
    if (speed < out.value) out = {speed, i};
  }
  return out;
}

TipProposal::Weakest TipProposal::weakest(const Axis& axis) const noexcept {
  Weakest out{kUnbounded, -1};
  for (std::int8_t i = 0; i < kJoints; ++i) {
    const double a = limits_.acceleration[i] / (axis.rate[i] + kTiny.joint);
    if (a < out.value) out = {a, i};
  }
  return out;
}

AxisLimits TipProposal::limits_of(const Axis& axis, const JointVector& room,
                                  double jerk) const noexcept {
  AxisLimits out{law_.speed_share * slowest(axis).value, kUnbounded, kUnbounded};
  for (int i = 0; i < kJoints; ++i) {
    const double rate = axis.rate[i] + kTiny.joint;
    out.acceleration = std::min(out.acceleration, room[i] / rate);
    out.jerk = std::min(out.jerk, jerk * limits_.jerk[i] / rate);
  }
  return out;
}

JointVector TipProposal::add(const Axes& axes, const JointVector& room, double jerk,
                             Vector6& out) const noexcept {
  JointVector taken = JointVector::Zero();
  for (std::size_t k = 0; k < axes.size(); ++k) {
    const Axis& axis = axes[k];
    if (axis.unit.isZero(0.0)) continue;
    double change =
        track_change(limits_of(axis, room, jerk), {0.0, axis.step, axis.change}, axis.ahead);
    // Braking that began with a larger share still does not turn back from what lies ahead.
    if (k == 0 && axis.ahead >= 0.0) change = std::max(change, -std::max(axis.step, 0.0));
    out += (axis.step + change) * axis.unit;
    taken += std::abs(change) * axis.rate;
  }
  return taken;
}

Twist TipProposal::step() const noexcept {
  Vector6 out = Vector6::Zero();
  const JointVector taken = add(place_, room_, kMotion.law_share, out);
  const JointVector left = left_of(limits_, room_, taken);
  add(turn_, left, kMotion.law_share * left.cwiseQuotient(room_).minCoeff(), out);
  return {out.head<3>(), out.tail<3>() / kMotion.turn_length};
}

Verdict TipProposal::limiting() const noexcept {
  const Axis& axis = std::abs(place_[0].ahead) > std::abs(turn_[0].ahead) ? place_[0] : turn_[0];
  const Weakest top = slowest(axis), weak = weakest(axis);
  if (axis.step > kMotion.law_share * law_.speed_share * top.value) {
    return {top.joint < 0 ? Reason::kTipSpeed : Reason::kJointSpeed, top.joint};
  }
  const bool hard = std::abs(axis.change) > kMotion.law_share * kMotion.law_share * weak.value;
  return {hard ? Reason::kJointAcceleration : Reason::kJointJerk, weak.joint};
}

}  // namespace handrail
