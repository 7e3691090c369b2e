#include "server/follow/follow_gap.h"

#include <algorithm>

namespace handrail {
namespace {

// More cycles than these at once are a gap: planning them takes time, and the controller has
// stood long enough to stand [cycles].
constexpr int kMostCycles = 4;
// A silent controller is asked every so many cycles: one that queues what it gets has little to
// work off then, and one that is back is heard 28 ms later at most.
constexpr int kAskEvery = 4;
// An answer that is late by anything up to two periods looks so once in 16 times: four in a row are
// chance once in eight minutes of such answers.
constexpr int kQueuedFor = 4;  // [answers]

}  // namespace

void begin_gap(const FollowSettings& settings, FollowState& s) noexcept {
  // An end that is not sent any more does not end the motion of the arm.
  s.halted = !standing(s.motion) || s.motion.joints.q != s.train.newest();
  s.halts += s.halted ? 1 : 0;
  s.motion = standing_at(settings.motion->arm, s.train.newest());
  s.gap = true;
  s.waited = 0;
  s.owed = static_cast<int>(s.train.unconfirmed());
}

bool asks_now(FollowState& s) noexcept { return s.waited++ % kAskEvery == 0; }

void hear_controller(const FollowSettings& settings, const FollowInput& in,
                     FollowState& s) noexcept {
  if (!s.placed) return;
  if (!in.robot_ready) {
    // Nobody is told anything: the arm is where it is, at rest.
    if (!standing(s.motion)) s.motion = standing_at(settings.motion->arm, s.train.newest());
    return;
  }
  const std::size_t unheard = s.train.unconfirmed();
  const bool told = in.answer != Answer::kNone && in.has_commanded;
  const bool elsewhere = told && !s.train.confirm(in.q_commanded, rated_step(settings));
  const bool paused = in.cycles > kMostCycles;
  s.another = s.another || in.anew;
  if (!s.gap) {
    if (paused || elsewhere || s.another) begin_gap(settings, s);
    return;
  }
  if (s.waited == 0 || paused || !told) return;
  s.waited = 0;  // it is there: ask again at once
  if (in.anew) s.owed = 0;
  // The controller answers in order. What it holds is known once it has answered a question, or
  // holds what was sent last.
  if ((elsewhere || s.train.unconfirmed() > 0) && s.owed-- > 0) return;
  // It may have taken this target just now. It has to hold it for a cycle: the next target is a
  // step from rest, and would end the motion at once.
  if (s.halted && s.train.unconfirmed() < unheard) return;
  const bool as_sent = !elsewhere && (!s.another || s.train.confirms(in.q_commanded));
  const JointVector q = as_sent ? s.train.confirmed() : in.q_commanded;
  if (joint_out_of_range(settings, q) >= 0) return;
  // The controller did not get the end of a motion that had ended here.
  if (!s.halted && q != s.train.newest()) ++s.halts;
  if (elsewhere) (q - s.train.newest()).cwiseAbs().maxCoeff(&s.elsewhere);
  place(settings, q, s);
}

bool controller_has_enough(const FollowInput& in, FollowState& s) noexcept {
  if (in.answer == Answer::kOnTime && !in.has_commanded) return false;
  const bool behind = in.answer == Answer::kOnTime && s.train.unconfirmed() > 0;
  s.queued_for = behind ? s.queued_for + 1 : 0;
  return s.queued_for >= kQueuedFor;
}

int joint_out_of_range(const FollowSettings& settings, const JointVector& q) noexcept {
  if (!kept(Check::kArmRange)) return -1;
  const double room = 2.0 * settings.following.room;
  for (int i = 0; i < kJoints; ++i) {
    if (!(q[i] >= settings.rated.lower[i] - room && q[i] <= settings.rated.upper[i] + room)) {
      return i;
    }
  }
  return -1;
}

}  // namespace handrail
