// What the slave knows of the controller's side: which of its targets were taken, and when it has
// to begin anew.
#pragma once

#include "server/base/deletable.h"
#include "server/follow/follow_step.h"

namespace handrail {

// Takes in what the controller has said. After a gap the motion stands, placed where the controller
// holds the arm, once that has answered to what was sent since. Real-time safe.
void hear_controller(const FollowSettings& settings, const FollowInput& in,
                     FollowState& state) noexcept;

// Halts the arm: it stays where the controller holds it, which is asked where. Which of the newest
// targets that is cannot be known, so none is sent again. Real-time safe.
void begin_gap(const FollowSettings& settings, FollowState& state) noexcept;

// The motion has come to its end, and no answer says that the controller holds it. An arm that does
// not would take the end, said again, as a step from rest, however long it has stood. Real-time
// safe.
inline bool ends_unheard(const FollowInput& in, const FollowState& state) noexcept {
  return in.answer == Answer::kNone && standing(state.motion) && state.train.unconfirmed() > 0 &&
         kept(Check::kHeardEnd);
}

// In a gap: whether to ask in this cycle. Real-time safe.
bool asks_now(FollowState& state) noexcept;

// The controller keeps targets for later and plays one a cycle: this cycle's is left out, and the
// arm goes on with those. Real-time safe.
bool controller_has_enough(const FollowInput& in, FollowState& state) noexcept;

// One rated step of every joint [rad].
inline JointVector rated_step(const FollowSettings& settings) noexcept {
  return settings.rated.max_speed * settings.motion->dt;
}

// The first joint of `q` outside its range by more than an arm at rest may be off (twice
// settings.following.room); -1: none. Real-time safe.
int joint_out_of_range(const FollowSettings& settings, const JointVector& q) noexcept;

// How old what the master said is, at least. Real-time safe.
inline Nanos age_of_master(const FollowInput& in) noexcept {
  return age_after(in.unseen, in.master_age);
}

}  // namespace handrail
