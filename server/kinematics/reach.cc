#include "server/kinematics/reach.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/kinematics/box_solve.h"
#include "server/kinematics/jacobian.h"

namespace handrail {
namespace {

constexpr double kAsTurned = 1e-5;  // [rad]
constexpr double kStrict = 1e10;    // weight of staying on the space; of going along it it is 1
constexpr double kTurn = 1e-8;      // weight of the orientation beside the place [m^2]
constexpr double kDamping = 1e-11;  // so that a solution exists
constexpr double kSlack = 1e-6;     // less beyond an end is rounding [rad]
constexpr int kSteps = 4;           // at most, of each least squares; the next call goes on
constexpr double kFound = 1e-10;    // [rad]
constexpr double kLongest = 0.3;    // of one step [rad]
constexpr double kBeyond = 1e6;     // what is within the ranges comes first

struct Ranges {
  JointVector low, high;

  double beyond(const JointVector& q, int i) const {
    return std::max({0.0, q[i] - high[i], low[i] - q[i]});
  }
  // The joint furthest beyond its end of those from `first`, -1 for none.
  std::int8_t worst(const JointVector& q, std::int8_t first, std::int8_t last) const {
    std::int8_t joint = -1;
    double most = kSlack;
    for (std::int8_t i = first; i <= last; ++i) {
      if (beyond(q, i) > most) {
        most = beyond(q, i);
        joint = i;
      }
    }
    return joint;
  }
  // The joint nearest to an end of its range.
  std::int8_t nearest_end(const JointVector& q, std::int8_t first, std::int8_t last) const {
    std::int8_t joint = first;
    double least = 1e9;
    for (std::int8_t i = first; i <= last; ++i) {
      const double left = std::min(high[i] - q[i], q[i] - low[i]);
      if (left < least) {
        least = left;
        joint = i;
      }
    }
    return joint;
  }
};

// The wrist's other ways to turn the tip as at `q`: flipped, J4 and J6 half a turn either way; the
// one within its ranges that is nearest to the seed.
JointVector best_wrist(const Ranges& ranges, const JointVector& q, const JointVector& seed) {
  // A flip turns J4 by half a turn: it is not nearer.
  const JointVector way = (q - seed).cwiseAbs();
  if (ranges.worst(q, 3, 5) < 0 && way.tail<3>().maxCoeff() < 0.5 * std::numbers::pi) return q;
  JointVector best = q;
  double least = 1e9;
  for (const int flip : {0, 1}) {
    for (const int turns_4 : {-1, 1}) {
      for (const int turns_6 : {-1, 1}) {
        JointVector c = q;
        if (flip == 1) c[4] = -q[4];
        c[3] += flip * turns_4 * std::numbers::pi;
        c[5] += flip * turns_6 * std::numbers::pi;
        const double beyond = ranges.beyond(c, 3) + ranges.beyond(c, 4) + ranges.beyond(c, 5);
        const double cost = (c - seed).tail<3>().cwiseAbs().maxCoeff() + kBeyond * beyond;
        if (cost < least) {
          least = cost;
          best = c;
        }
      }
    }
  }
  return best;
}

// How the way to the wrist centre's goal turns with J1 to J3, for a part `way` of it that stays:
// the second derivative of half its square beside the first ones' products.
Mat3 bend_of(const ArmGeometry& to_wrist, const JointVector& q, const Vec3& way) {
  const TipJacobian J = tip_jacobian(to_wrist, q);
  Mat3 bend;
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      bend(i, j) = bend(j, i) = -way.dot(J.angular.col(i).cross(J.linear.col(j)));
    }
  }
  return bend;
}

// Some steps of J1 to J3 that bring the wrist centre toward `goal`, or as near as it may along the
// space; where it comes.
Vec3 reach_wrist(const ArmGeometry& arm, const Ranges& ranges, const TipSpace& space,
                 const Vec3& goal, JointVector& q) {
  ArmGeometry to_wrist = arm;
  to_wrist.d6 = 0.0;
  to_wrist.X_AT.reset();
  q = q.cwiseMax(ranges.low).cwiseMin(ranges.high);
  for (int step = 0; step < kSteps; ++step) {
    const Mat3 J = tip_jacobian(to_wrist, q).linear.leftCols<3>();
    const Vec3 way = goal - forward(to_wrist, q).p;
    Vec3 along = Vec3::Zero(), g = Vec3::Zero();
    Mat3 H = kDamping * Mat3::Identity();
    for (int k = 0; k < 3; ++k) {
      const Vec3 axis = space.axes_S.col(k);
      const Vec3 row = J.transpose() * axis;
      const double weight = k < space.freedom() ? 1.0 : kStrict;
      if (k < space.freedom()) along += axis.dot(way) * axis;
      H += weight * row * row.transpose();
      g += weight * axis.dot(way) * row;
    }
    // What of the way stays out of reach bends the circles the joints move on: without that the
    // steps toward something far away would overshoot. Where the exact bend has no least, the most
    // it can be.
    const Mat3 exact = H + bend_of(to_wrist, q, along);
    if (exact.ldlt().isPositive() && exact.ldlt().vectorD().minCoeff() > kDamping) {
      H = exact;
    } else {
      H.diagonal() += along.norm() * J.colwise().norm().transpose();
    }
    const Vec3 longest = Vec3::Constant(kLongest);
    const Vec3 low = (ranges.low - q).head<3>().cwiseMax(-longest);
    const Vec3 high = (ranges.high - q).head<3>().cwiseMin(longest);
    const Vec3 d = solve_in_box<3>(H, g, low, high, Vec3::Ones());
    q.head<3>() += d;
    if (d.cwiseAbs().maxCoeff() < kFound) break;
  }
  return forward(to_wrist, q).p;
}

// Some steps that turn the tip toward `goal` as near as the ranges allow, in its place.
JointVector turn_tip(const ArmGeometry& arm, const Ranges& ranges, const Pose& goal,
                     JointVector q) {
  q = q.cwiseMax(ranges.low).cwiseMin(ranges.high);
  for (int step = 0; step < kSteps; ++step) {
    const Pose X = forward(arm, q);
    const TipJacobian J = tip_jacobian(arm, q);
    const Vec3 turn = rotation_log(goal.q * X.q.conjugate());
    Eigen::Matrix<double, kJoints, kJoints> H =
        J.linear.transpose() * J.linear + kTurn * J.angular.transpose() * J.angular;
    // As above, for what stays of the turn.
    H.diagonal().array() += kDamping + kTurn * turn.norm();
    const JointVector g =
        J.linear.transpose() * (goal.p - X.p) + kTurn * J.angular.transpose() * turn;
    const JointVector longest = JointVector::Constant(kLongest);
    const JointVector low = (ranges.low - q).cwiseMax(-longest);
    const JointVector high = (ranges.high - q).cwiseMin(longest);
    const JointVector d = solve_in_box<kJoints>(H, g, low, high, JointVector::Ones());
    q += d;
    if (d.cwiseAbs().maxCoeff() < kFound) break;
  }
  return q;
}

}  // namespace

Reached nearest_reachable(const ArmGeometry& arm, const JointLimits& limits, const TipSpace& space,
                          const Pose& X, const JointVector& seed,
                          const JointVector& inside) noexcept {
  const Ranges ranges{limits.lower + inside, limits.upper - inside};
  Reached out{seed, X, -1, false};
  const bool solved = inverse_near(arm, X, seed, out.q) == InverseStatus::kOk;
  if (solved) out.q = best_wrist(ranges, out.q, seed);
  out.joint = solved ? ranges.worst(out.q, 0, 5) : std::int8_t{2};
  if (out.joint < 0) return out;

  // The place first, turned as the tip is now; then the turn.
  Pose goal{X.p, forward(arm, seed).q};
  // Turned as asked for it forgets by how little it is not, cycle after cycle.
  if (angle_between(goal.q, X.q) < kAsTurned) goal.q = X.q;
  JointVector q = seed;
  out.arm = inverse_near(arm, goal, seed, q) != InverseStatus::kOk || ranges.worst(q, 0, 2) >= 0;
  if (out.arm) {
    q = seed;
    const Vec3 to_tip = arm.wrist_to_tip(goal.q);
    goal.p = space.nearest(reach_wrist(arm, ranges, space, X.p - to_tip, q) + to_tip);
    out.joint = ranges.nearest_end(q, 0, 2);
    // The place in reach moves as the tip turns; it is not left for one that is further away.
    const Vec3 here = space.nearest(forward(arm, seed).p);
    if ((here - X.p).norm() < (goal.p - X.p).norm()) {
      goal.p = here;
      q = seed;
    } else {
      inverse_near(arm, goal, q, q);
    }
  }
  out.q = turn_tip(arm, ranges, {goal.p, X.q}, q);
  out.X = {goal.p, forward(arm, out.q).q};
  return out;
}

}  // namespace handrail
