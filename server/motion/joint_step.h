// What the joints can do in one cycle, and their best step toward a place.
#pragma once

#include "server/kinematics/jacobian.h"
#include "server/motion/stop_plan.h"

namespace handrail {

// What each joint may do this cycle [rad].
struct StepBox {
  StepBox(const PlanLimits& limits, const GuardState& joints) noexcept;
  bool holds(const JointVector& step) const noexcept {
    return (step - low).minCoeff() >= 0.0 && (high - step).minCoeff() >= 0.0;
  }
  JointVector low, high;
};

// Whether `q` lies in that box. Mostly the planned bounds plainly hold it, and the box is not
// worked out. Real-time safe.
bool in_box(const PlanLimits& limits, const GuardState& joints, const JointVector& q) noexcept;

// The joints' own steps toward `there`, each at a speed that brings all there together, with the
// share 0..1 of it. Real-time safe.
JointVector own_steps(const PlanLimits& limits, const GuardState& joints, const JointVector& there,
                      double share) noexcept;

// The step in `box` from `q` that takes the tip to `p` [m], or as near as it can; of all that do,
// the one nearest to `own`. `J`: how the tip moves with the joints. One least squares. Real-time
// safe.
JointVector step_in_box(const PlanLimits& limits, const StepBox& box,
                        const Eigen::Matrix<double, 3, kJoints>& J, const JointVector& q,
                        const Vec3& p, const JointVector& own) noexcept;

// Solves X on the branch of `seed`; of both wrist branches the one nearer to it
// where J5 is small, since a path straight through J5 = 0 keeps J4 and J6.
// Real-time safe.
bool solve_near(const ArmGeometry& arm, const Pose& X, const JointVector& seed,
                JointVector& q) noexcept;

}  // namespace handrail
