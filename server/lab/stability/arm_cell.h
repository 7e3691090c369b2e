// The arm led to and through where it cannot go on as it did, by a passive hand that is kicked
// there.
#pragma once

#include "server/base/joints.h"
#include "server/base/spatial.h"
#include "server/lab/stability/stability_case.h"

namespace handrail {

// From `from` the hand asks the tip to go straight by `by`, turning by `turn`, and back. Frame S.
struct ArmWay {
  JointVector from = JointVector::Zero();  // [rad]
  Vec3 by = Vec3::Zero();                  // [m]
  Vec3 turn = Vec3::Zero();                // [rad]
  double tip_speed = 1.0;                  // at most, > 0 [m/s]
};

// At both ends the hand is kicked by half a metre a second, its stylus shaken by 0.3 rad, and it is
// to be still for four seconds.
//
//   joint_share   of what every joint may do in a cycle: speed, acceleration and jerk
//   breaches      of these, of ranges, and targets that are not finite
//   bounds        of what the steps of force and command may be (server/lab/sequences/bounds.h)
//   still_mrad    by how much a joint's target moves in the last second
//   tip_swing_mm  of the true tip in it
//   growth_mrad   by how much more a joint's target moves in it than in the one before
//   energy_mj     that the hand was given in a way there and back, beyond what the device took
//   ended         the engagement ended
CaseOutcome run_arm_way(const ArmWay& way, std::uint64_t seed);

}  // namespace handrail
