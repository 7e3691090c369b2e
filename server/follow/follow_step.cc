#include "server/follow/follow_step.h"

#include <algorithm>

#include "server/base/deletable.h"
#include "server/follow/follow_gap.h"
#include "server/follow/follow_ledger.h"

namespace handrail {
namespace {

// The first command must stand on the held pose. The master copies it from our own state, so a
// larger difference means that it has not heard us yet, or does not mean this arm.
constexpr double kAlignDistance = 1e-6;  // [m]
constexpr double kAlignAngle = 1e-6;     // [rad]
// One bad reading costs nothing, a third in a row is a sensor not to be worked with.
constexpr int kInvalidWrenches = 3;

bool valid_command(const MasterState& master) {
  return master.has_command && is_place(master.X_SU);
}

bool aligned(const MasterState& master, const MotionState& motion) {
  return valid_command(master) && standing(motion) &&
         (master.X_SU.p - motion.X_ST.p).norm() < kAlignDistance &&
         angle_between(master.X_SU.q, motion.X_ST.q) < kAlignAngle;
}

bool stop_stands(const FollowInput& in) {
  return in.master_known && kept(Check::kStopEpoch) &&
         in.master.stop_epoch != in.master.released_epoch;
}

// A master in hold leads nobody: it hears nothing of the arm.
bool leads(SessionState master) {
  return follows(master) || (master == SessionState::kHold && !kept(Check::kMasterHold));
}

// `obstacle`: why this side cannot be engaged now.
void advance_session(const FollowSettings& settings, const FollowInput& in, FollowState& s,
                     Reason own_fault, Reason obstacle) {
  SlaveSessionInput session;
  session.link = rung_of(in.master_known, age_of_master(in), in.link);
  session.confirmed = in.link.confirmed;
  session.robot_ready = in.robot_ready && s.placed;
  session.fault = in.stop_input && kept(Check::kStopInput) ? Reason::kStopInput
                  : in.fault != Reason::kNone              ? in.fault
                                                           : own_fault;
  session.shutdown = in.shutdown;
  session.obstacle = obstacle;
  session.stop_latched = stop_stands(in);
  session.fault_released = released(in, s);
  session.same_engagement = in.master.engagement_epoch == s.engagement_epoch;
  if (in.master_known) {
    session.desired = in.master.desired;
    session.master = in.master.state;
    session.aligned = aligned(in.master, s.motion);
    if (kept(Check::kHashes)) session.mismatch = first_difference(settings, in.master);
  }
  const SessionState before = s.session;
  const SessionStep next = next_slave(before, session);
  s.session = next.state;
  const bool asked = next.state == SessionState::kAligning || next.state == SessionState::kHoming;
  if (asked && before != SessionState::kAligning) s.engagement_epoch = in.master.engagement_epoch;
  // The first cause stays until reset. A stop that comes on top, and a cause that is still there
  // when it is reset, are new ones.
  const bool new_stop = session.stop_latched && s.stop_epoch != in.master.stop_epoch;
  const bool reset = session.fault_released && next.reason != Reason::kNone;
  if (next.state != SessionState::kFault || before != SessionState::kFault || new_stop || reset) {
    s.session_reason = next.reason;
    s.fault = next.state == SessionState::kFault ? next.reason : Reason::kNone;
    if (next.state == SessionState::kFault) ++s.fault_epoch;
  }
  if (session.stop_latched) s.stop_epoch = in.master.stop_epoch;
  // Nothing moves: the tools are what the master says they are.
  if (in.master_known && !follows(s.session) && s.session != SessionState::kHold) {
    s.tube.restart(in.master, s.motion.X_ST);
    s.bumper = BumperState();
  }
}

// Between fresh and hold the approach slows to nothing.
double share_of_speed(Nanos age) {
  if (!kept(Check::kWatchdog)) return 1.0;
  const double over = to_seconds(age - 5 * kMillisecond) / 0.015;
  return std::clamp(1.0 - over, 0.0, 1.0);
}

// Takes over a valid reading, turned by the measured orientation and without the payload's part;
// says what is wrong with an invalid one. The commanded orientation is ahead of the sensor.
Reason read_force(const FollowSettings& settings, const FollowInput& in, const Pose& X_ST,
                  FollowState& s) {
  const bool still = s.placed && standing(s.motion);
  const WrenchReading reading{in.f_E_T, in.wrench_valid, X_ST, still,
                              settings.payload.reading(X_ST.q).force};
  const Reason wrong =
      s.wrench.judge(settings.bumper, settings.sensor_range, settings.motion.dt, reading);
  if (wrong == Reason::kNone) {
    s.invalid_wrenches = 0;
    const Wrench f_E_T = settings.payload.remove(in.f_E_T, X_ST.q);
    s.f_E_S = s.filter.pass(X_ST.q * f_E_T.force, settings.force_lag, settings.motion.dt);
    s.torque_E_S = X_ST.q * f_E_T.torque;
    return Reason::kNone;
  }
  s.invalid_wrenches = std::min(s.invalid_wrenches + 1, kInvalidWrenches);
  if (wrong == Reason::kSensorStuck) s.invalid_wrenches = kInvalidWrenches;
  if (s.invalid_wrenches < kInvalidWrenches) return Reason::kNone;  // the last reading stands
  s.f_E_S.setZero();
  s.filter.restart();
  return wrong;
}

// A fault the arm itself shows, and its joint. Without an answer nothing is known of it; in a gap
// not what it follows.
Reason judge_arm(const FollowSettings& settings, const FollowInput& in,
                 const JointVector& q_measured, FollowState& s, std::int8_t& joint) {
  const double dt = settings.motion.dt;
  const bool answered = in.answer != Answer::kNone && in.has_measured;
  const bool judged = s.placed && !s.gap;
  for (int i = answered ? 1 : 0; judged && i < in.cycles; ++i) {
    s.following.pass(settings.following, s.motion.joints.q, dt);
  }
  if (!answered) return Reason::kNone;
  const bool lost =
      judged && s.following.lost(settings.following, s.motion.joints.q, q_measured, dt);
  if (s.joints.broken()) {
    joint = static_cast<std::int8_t>(s.joints.joint());
    return Reason::kEncoderInvalid;
  }
  if (const int i = joint_out_of_range(settings, q_measured); in.robot_ready && i >= 0) {
    joint = static_cast<std::int8_t>(i);
    return Reason::kEncoderInvalid;
  }
  if (!lost) return Reason::kNone;
  joint = static_cast<std::int8_t>(s.following.joint());
  return Reason::kFollowingError;
}

// Where the commands so far bring the tip to rest [m].
Vec3 rest_place(const FollowSettings& settings, const MotionState& motion) {
  const StopPlan& stop = motion.stop;
  if (stop.done()) return motion.X_ST.p;
  return forward(settings.motion.arm, stop.q[static_cast<std::size_t>(stop.size - 1)]).p;
}

// From where the bumper reckons: where the tip comes to rest, but never further out of a contact
// than it is told to be now. An arm that turns fast stops late, and would be led ever further out.
Vec3 bumped_from(const FollowSettings& settings, const FollowState& s) {
  const Vec3 rest = rest_place(settings, s.motion), now = s.motion.X_ST.p;
  return s.bumper.touching() && (rest - now).dot(s.bumper.n_S) > 0.0 ? now : rest;
}

// What is wrong with the contact.
Reason judge_contact(const FollowSettings& settings, const Vec3& p_measured, FollowState& s) {
  const Vec3 moved = p_measured - s.p_measured;
  s.p_measured = p_measured;
  if (!settings.bumper.enabled || settings.bumper.form == BumperSettings::Form::kPublished ||
      !s.placed) {
    return Reason::kNone;
  }
  if (!follows(s.session)) {
    s.contact = ContactMonitor();
    return Reason::kNone;
  }
  const Reason found = s.contact.judge(settings.bumper, s.f_E_S, moved,
                                       rest_place(settings, s.motion), settings.motion.dt);
  if (found == Reason::kSensorSign && !kept(Check::kSensorSign)) return Reason::kNone;
  if (found == Reason::kContactUnrelieved && !kept(Check::kRelief)) return Reason::kNone;
  return found;
}

// How far the published bumper may take the tip off its tool: what it yields to twice its threshold
// [m]. A default one backs off as far as the contact needs.
double most_yielding(const FollowSettings& settings) {
  return settings.bumper.alpha * std::min(settings.sensor_range, 2.0 * settings.bumper.threshold);
}

// Moves toward the newest command and says by which stages; returns what intervened.
Reason follow(const FollowSettings& settings, const FollowInput& in, FollowState& s,
              FollowLedger& ledger) {
  // Engaged before its master knows, a slave stands: what comes is not yet driven by a hand.
  if (!leads(in.master.state)) {
    brake(settings.motion, s.motion);
    return in.master.state == SessionState::kHold ? Reason::kLinkHold : Reason::kNotEngaged;
  }
  if (!valid_command(in.master)) {
    brake(settings.motion, s.motion);
    return Reason::kCommandInvalid;
  }
  if (s.tube.take(in.master, s.motion.X_ST) != Reason::kNone) {
    brake(settings.motion, s.motion);
    return Reason::kHashTools;
  }
  s.oldest_applied = std::max(s.oldest_applied, age_of_master(in));
  s.applied_sequence = in.master_sequence;
  if (s.session == SessionState::kEngaged) {
    s.tube.close(settings.catch_up, settings.catch_up_rotation, in.master.X_SU.p, s.motion.X_ST.p,
                 settings.motion.dt);
  }
  const Pose X_SN = s.tube.project(in.master.X_SU, s.motion.X_ST);
  BumperInput contact;
  contact.p_SU = X_SN.p;
  contact.f_E_S = s.f_E_S;
  contact.fresh = s.invalid_wrenches == 0;
  contact.p_ST = s.p_measured;
  contact.delay = settings.bumper.sensor_lag + (kept(Check::kLag) ? s.lag.lag() : 0.0);
  contact.dt = settings.motion.dt;
  const bool published = settings.bumper.form == BumperSettings::Form::kPublished;
  contact.p_last = published ? s.motion.X_ST.p : bumped_from(settings, s);
  Bumped bumped{X_SN.p};
  if (kept(Check::kContact)) bumped = bump(settings.bumper, contact, s.bumper);
  if (published) bumped.p_SB = s.tube.bounded(bumped.p_SB, most_yielding(settings));
  // Beside its tool the tip goes only as far as command and contact take it; one that comes nearer
  // from further off, or flies by when the tool is called, does not go further than it is.
  const double room = std::max(s.tube.distance(bumped.p_SB), s.tube.distance(s.motion.X_ST.p));
  TipSpace space = s.tube.space(room);
  if (s.bumper.phase != BumperState::Phase::kFree) {
    // Out of a contact the way is free, whichever way the tool goes.
    space.forward_S.setZero();
    space.side_S.setZero();
    space.touched = true;
  }
  const Moved moved = move_toward(settings.motion, space, {bumped.p_SB, X_SN.q},
                                  share_of_speed(age_of_master(in)), s.motion);
  const Vec3 on_tool = X_SN.p - in.master.X_SU.p, yielded = bumped.p_SB - X_SN.p;
  const Reason tube = on_tool.isZero(0.0)     ? Reason::kNone
                      : s.tube.radius() > 0.0 ? Reason::kToolBlending
                                              : Reason::kToolTube;
  put_stage(ledger, FollowStage::kTube, on_tool, tube);
  put_stage(ledger, FollowStage::kBumper, yielded,
            yielded.isZero(0.0)           ? Reason::kNone
            : bumped.why == Reason::kNone ? Reason::kBumper
                                          : bumped.why);
  put_stage(ledger, FollowStage::kReach, moved.p_goal - bumped.p_SB, moved.reach.reason);
  put_stage(ledger, FollowStage::kLimits, s.motion.X_ST.p - moved.p_goal, moved.limit.reason);
  const Verdict& why = moved.reach.reason != Reason::kNone ? moved.reach : moved.limit;
  ledger.joint = why.joint;
  return bumped.why != Reason::kNone ? bumped.why : why.reason;
}

// The commands of one cycle, through the guard; returns what intervened.
Reason move_once(const FollowSettings& settings, const FollowInput& in, FollowState& s,
                 FollowLedger& ledger) {
  Reason intervention = Reason::kNone;
  const GuardState before = s.motion.joints;
  if (follows(s.session)) {
    intervention = follow(settings, in, s, ledger);
  } else {
    brake(settings.motion, s.motion);
  }
  const Vec3 planned = s.motion.X_ST.p;
  const Verdict safe = pass_guard(settings.motion, before, s.motion);
  if (safe.reason == Reason::kNone) return intervention;
  ++s.guarded;
  if (follows(s.session)) {
    put_stage(ledger, FollowStage::kLimits,
              ledger.off_S.col(static_cast<int>(FollowStage::kLimits)).cast<double>() +
                  s.motion.X_ST.p - planned,
              safe.reason);
  }
  return safe.reason;
}

// The commands of the cycles that have passed, and whether the newest is to be sent; returns what
// intervened.
Reason move_commands(const FollowSettings& settings, const FollowInput& in, FollowState& s,
                     FollowLedger& ledger, Send& send) {
  send = Send::kNothing;
  if (!s.placed || !in.robot_ready) return Reason::kNone;
  Reason intervention = Reason::kNone;
  if (!s.gap) {
    if (controller_has_enough(in, s)) return Reason::kNone;
    // A standing arm has nothing to make up for: it sets out with the step of one cycle.
    const int cycles = standing(s.motion) ? std::min(in.cycles, 1) : in.cycles;
    for (int i = 0; i < cycles; ++i) intervention = move_once(settings, in, s, ledger);
    const bool too_far = !s.train.may_send(s.motion.joints.q, rated_step(settings));
    if (too_far || ends_unheard(in, s)) begin_gap(settings, s);
  }
  if (s.gap) {
    if (asks_now(s)) send = Send::kQuestion;
    return Reason::kRobotSilent;
  }
  send = Send::kTarget;
  s.train.add(s.motion.joints.q);
  return intervention;
}

}  // namespace

bool released(const FollowInput& in, const FollowState& state) noexcept {
  const bool seen = in.master.fault_reset == state.fault_epoch || !kept(Check::kResetSeen);
  return state.session == SessionState::kFault && in.master_known && in.link.confirmed &&
         !stop_stands(in) && seen;
}

void place(const FollowSettings& settings, const JointVector& q, FollowState& state) noexcept {
  state.motion = standing_at(settings.motion.arm, q);
  state.joints = JointMonitor();
  state.following.restart(q);
  state.lag.restart(q);
  state.bumper = BumperState();
  state.p_measured = state.motion.X_ST.p;
  state.placed = true;
  state.train.restart(q);
  state.gap = state.another = false;
  state.waited = state.queued_for = 0;
}

void follow_step(const FollowSettings& settings, const FollowInput& in, FollowState& s,
                 FollowOutput& out) noexcept {
  ++s.cycles;
  hear_controller(settings, in, s);
  const bool answered = in.answer != Answer::kNone && in.has_measured;
  s.joints.pass(in.cycles);
  const JointVector q_measured = answered ? s.joints.judge(in.q_measured) : s.joints.newest();
  const Pose X_measured = forward(settings.motion.arm, q_measured);
  const Reason sensor = read_force(settings, in, X_measured, s);
  if (s.placed) s.lag.add(s.motion.joints.q, q_measured, settings.motion.dt);
  const Reason contact = judge_contact(settings, X_measured.p, s);
  FollowLedger ledger;
  Reason fault = judge_arm(settings, in, q_measured, s, ledger.joint);
  // An arm that somebody else has moved does not drive back by itself.
  if (s.session == SessionState::kOff) s.elsewhere = -1;
  const bool moved = s.elsewhere >= 0 && s.session != SessionState::kFault;
  if (fault == Reason::kNone && moved) fault = Reason::kEncoderInvalid;
  if (fault != Reason::kNone) s.lag.restart(q_measured);
  if (fault == Reason::kNone && settings.sensor_required && follows(s.session)) fault = sensor;
  if (fault == Reason::kNone && follows(s.session)) fault = contact;
  const Reason obstacle = settings.sensor_required ? sensor : Reason::kNone;
  advance_session(settings, in, s, fault, obstacle);
  const Reason intervention = move_commands(settings, in, s, ledger, out.send);
  out.q_target = s.placed ? s.motion.joints.q : q_measured;

  if (s.fault == Reason::kEncoderInvalid && s.elsewhere >= 0) {
    ledger.joint = static_cast<std::int8_t>(s.elsewhere);
  }
  // A contact that is held because nothing is known of it is the sensor's doing.
  const bool blind = sensor != Reason::kNone;
  SlaveState& link = out.link;
  link.state = s.session;
  link.fault = s.fault;
  link.reason = s.session == SessionState::kFault   ? s.fault
                : s.session_reason != Reason::kNone ? s.session_reason
                : intervention != Reason::kNone && !(intervention == Reason::kBumper && blind)
                    ? intervention
                    : sensor;
  link.X_ST_command = s.motion.X_ST;
  link.X_ST = X_measured;
  link.has_pose = s.placed && in.robot_ready && is_finite(link.X_ST);
  link.q_measured = q_measured;
  link.f_E_S = {s.f_E_S, s.torque_E_S};
  link.has_wrench = s.invalid_wrenches == 0;
  if (!link.has_wrench) link.f_E_S.torque.setZero();
  link.payload_removed = !settings.payload.is_none();
  link.stop_epoch = s.stop_epoch;
  link.fault_epoch = s.fault_epoch;
  link.engagement_epoch = s.engagement_epoch;
  // What a reset would meet again, whatever was latched on top of it.
  const Reason still = in.stop_input               ? Reason::kStopInput
                       : in.fault != Reason::kNone ? in.fault
                                                   : fault;
  link.obstacle = follows(s.session) || s.session == SessionState::kHold ? Reason::kNone
                  : still != Reason::kNone                               ? still
                                                                         : obstacle;
  link.position_tool_epoch = s.tube.position_epoch();
  link.orientation_tool_epoch = s.tube.orientation_epoch();
  link.oldest_applied = s.oldest_applied;
  link.cycles = s.cycles;
  link.applied_sequence = s.applied_sequence;
  link.ledger = ledger;
  link.hashes = settings.hashes;
  link.hashes.tools = s.tube.hash();
  link.scene = settings.scene;
}

}  // namespace handrail
