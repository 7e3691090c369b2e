#include "server/follow/follow_way.h"

#include <algorithm>

#include "server/base/deletable.h"
#include "server/follow/follow_gap.h"
#include "server/follow/follow_judges.h"
#include "server/follow/follow_ledger.h"

namespace handrail {
namespace {

// Where a stage puts the tip, and why that is not where the one before did.
struct Stage {
  Vec3 p = Vec3::Zero();  // [S, m]
  Reason why = Reason::kNone;
};

// A master in hold leads nobody: it hears nothing of the arm.
bool leads(SessionState master) {
  return follows(master) || (master == SessionState::kHold && !kept(Check::kMasterHold));
}

// Between fresh and hold the approach slows to nothing.
double share_of_speed(Nanos age) {
  if (!kept(Check::kWatchdog)) return 1.0;
  const double over = to_seconds(age - 5 * kMillisecond) / 0.015;
  return std::clamp(1.0 - over, 0.0, 1.0);
}

// Why the newest command is not followed; kNone: it is.
Reason refusal(const FollowInput& in, FollowState& s) {
  // Engaged before its master knows, a slave stands: what comes is not yet driven by a hand.
  if (!leads(in.master.state)) {
    return in.master.state == SessionState::kHold ? Reason::kLinkHold : Reason::kNotEngaged;
  }
  if (!valid_command(in.master)) return Reason::kCommandInvalid;
  return s.tube.take(in.master, s.motion.X_ST);
}

// The slave's own hold on the tools.
Stage hold_on_tool(const FollowInput& in, const Pose& X_SN, const FollowState& s) {
  if (X_SN.p == in.master.X_SU.p) return {X_SN.p};
  return {X_SN.p, s.tube.radius() > 0.0 ? Reason::kToolBlending : Reason::kToolTube};
}

// From where the bumper reckons: where the tip comes to rest, but never further out of a contact
// than it is told to be now. An arm that turns fast stops late, and would be led ever further out.
Vec3 bumped_from(const FollowState& s) {
  const Vec3 rest = rest_place(s.motion), now = s.motion.X_ST.p;
  return s.bumper.touching() && (rest - now).dot(s.bumper.n_S) > 0.0 ? now : rest;
}

// How far the published bumper may take the tip off its tool: what it yields to twice its threshold
// [m]. A default one backs off as far as the contact needs.
double most_yielding(const FollowSettings& settings) {
  return settings.bumper.alpha * std::min(settings.sensor_range, 2.0 * settings.bumper.threshold);
}

// Contact.
Stage yield(const FollowSettings& settings, const Vec3& p_SN, FollowState& s, Reason& why) {
  BumperInput contact;
  contact.p_SU = p_SN;
  contact.f_E_S = s.f_E_S;
  contact.fresh = s.invalid_wrenches == 0;
  contact.p_ST = s.p_measured;
  contact.delay = settings.bumper.sensor_lag + (kept(Check::kLag) ? s.lag.lag() : 0.0);
  contact.dt = settings.motion->dt;
  const bool published = settings.bumper.form == BumperSettings::Form::kPublished;
  contact.p_last = published ? s.motion.X_ST.p : bumped_from(s);
  Bumped bumped{p_SN};
  if (kept(Check::kContact)) bumped = bump(settings.bumper, contact, s.bumper);
  if (settings.bumper.enabled && !published) s.surface.step(settings.bumper, contact, s.bumper);
  if (published) bumped.p_SB = s.tube.bounded(bumped.p_SB, most_yielding(settings));
  why = bumped.why;
  if (bumped.p_SB == p_SN) return {bumped.p_SB};
  return {bumped.p_SB, why == Reason::kNone ? Reason::kBumper : why};
}

// Where the tip may be on its way to `p`.
TipSpace space_to(const Vec3& p, const FollowState& s) {
  // Beside its tool the tip goes only as far as command and contact take it; one that comes nearer
  // from further off, or flies by when the tool is called, does not go further than it is.
  const double room = std::max(s.tube.distance(p), s.tube.distance(s.motion.X_ST.p));
  TipSpace space = s.tube.space(room);
  if (s.bumper.phase != BumperState::Phase::kFree) {
    // Out of a contact the way is free, whichever way the tool goes.
    space.forward_S.setZero();
    space.side_S.setZero();
    space.touched = true;
  }
  return space;
}

}  // namespace

Led lead(const FollowSettings& settings, const FollowInput& in, FollowState& s,
         FollowLedger& ledger) noexcept {
  if (const Reason refused = refusal(in, s); refused != Reason::kNone) {
    return {brake(settings.motion, s.motion), refused};
  }
  s.oldest_applied = std::max(s.oldest_applied, age_of_master(in));
  s.applied_sequence = in.master_sequence;
  if (s.session == SessionState::kEngaged) {
    s.tube.close(settings.catch_up, settings.catch_up_rotation, in.master.X_SU.p, s.motion.X_ST.p,
                 settings.motion->dt);
  }
  const Pose X_SN = s.tube.project(in.master.X_SU, s.motion.X_ST);
  Reason contact = Reason::kNone;
  const Stage command{in.master.X_SU.p};
  const Stage tool = hold_on_tool(in, X_SN, s);
  const Stage bumped = yield(settings, X_SN.p, s, contact);
  const Moved moved = move_toward(settings.motion, space_to(bumped.p, s), {bumped.p, X_SN.q},
                                  share_of_speed(age_of_master(in)), s.motion);
  const Stage reached{moved.p_goal, moved.reach.reason};
  const Stage limited{moved.next.X_ST.p, moved.limit.reason};
  const Stage* const way[] = {&command, &tool, &bumped, &reached, &limited};
  for (int i = 0; i < FollowLedger::kStages; ++i) {
    put_stage(ledger, static_cast<FollowStage>(i), way[i + 1]->p - way[i]->p, way[i + 1]->why);
  }
  const Verdict& why = moved.reach.reason != Reason::kNone ? moved.reach : moved.limit;
  ledger.joint = why.joint;
  return {moved.next, contact != Reason::kNone ? contact : why.reason};
}

}  // namespace handrail
