// A way to rest for the whole arm, on the tool and within every limit, found
// before it is needed.
#pragma once

#include <array>

#include "server/base/spatial.h"
#include "server/model/tip_space.h"
#include "server/motion/guard.h"

namespace handrail {

// Joint commands, one a cycle, of which the last two are the same. 64 cycles
// hold v/a + 2.5 a/j of the arm's own limits; with slower ones the arm moves so
// slowly that they suffice.
struct StopPlan {
  static constexpr int kCapacity = 64;
  std::array<JointVector, kCapacity> q;
  int size = 0;
  int next = 0;

  bool done() const noexcept { return next >= size; }
};

// What a radian counts beside a metre where place and turn are one motion [m].
inline constexpr double kTurnLength = 0.2;

using Vector6 = Eigen::Matrix<double, 6, 1>;

inline Vector6 six(const Twist& t) noexcept {
  Vector6 out;
  out << t.linear, kTurnLength * t.angular;
  return out;
}

// Where the commands stand: nothing here is measured.
struct TipMotion {
  GuardState joints;
  Pose X_ST;         // tip at joints.q
  Twist tip_step;    // what it moved in the last cycle, frame S [m], [rad]
  Twist tip_change;  // how that grew
};

// The guard's limits, and the share of them that is planned with.
struct PlanLimits {
  explicit PlanLimits(const GuardLimits& of) noexcept;
  GuardLimits guard;
  std::array<AxisLimits, kJoints> axis;
  JointVector from_end;  // of a joint's range, where the guard surely lets it come to rest [rad]
};

// Whether `wanted` is within the planned share of speed, acceleration and jerk,
// and the guard lets it pass. Real-time safe.
Verdict plan_allows(const PlanLimits& limits, const GuardState& state,
                    const JointVector& wanted) noexcept;

// `wanted` becomes the newest command.
void advance(const PlanLimits& limits, GuardState& state, const JointVector& wanted) noexcept;

// Solves X on the branch of `seed`; of both wrist branches the one nearer to it
// where J5 is small, since a path straight through J5 = 0 keeps J4 and J6.
// Real-time safe.
bool solve_near(const ArmGeometry& arm, const Pose& X, const JointVector& seed,
                JointVector& q) noexcept;

// Stops from `from` along its path, on `space` throughout, no longer than v/a
// + 2.5 a/j of the slowest-stopping joint. Every command of it was asked of the
// guard. Where the path's own stop does not fit each joint may stop by itself, if that ends less
// than `beside` [m] beside the path; 0: never. False with the reason in `why` when there is none.
// Real-time safe, at most 9 x 64 inverse kinematics.
bool plan_stop(const PlanLimits& limits, const TipSpace& space, const TipMotion& from,
               double beside, StopPlan& plan, Verdict& why) noexcept;

}  // namespace handrail
