// What the slave makes of its sensor and its arm, before it moves.
#pragma once

#include "server/follow/follow_step.h"

namespace handrail {

// Takes over a valid reading, turned by the measured orientation and without the payload's part;
// says what is wrong with an invalid one. The commanded orientation is ahead of the sensor.
// `X_ST`: by the measured joints. Real-time safe.
Reason read_force(const FollowSettings& settings, const FollowInput& in, const Pose& X_ST,
                  FollowState& state) noexcept;

// A fault the arm itself shows, and its joint. Without an answer nothing is known of it; in a gap
// not what it follows. Real-time safe.
Reason judge_arm(const FollowSettings& settings, const FollowInput& in,
                 const JointVector& q_measured, FollowState& state, std::int8_t& joint) noexcept;

// What is wrong with the contact of a tip that is measured at `p_measured` [S, m]. Real-time safe.
Reason judge_contact(const FollowSettings& settings, const Vec3& p_measured,
                     FollowState& state) noexcept;

}  // namespace handrail
