#include "server/follow/follow_step.h"

#include <algorithm>

#include "server/base/deletable.h"
#include "server/follow/follow_gap.h"
#include "server/follow/follow_judges.h"
#include "server/follow/follow_ledger.h"
#include "server/follow/follow_way.h"

namespace handrail {
namespace {

// The first command must stand on the held pose. The master copies it from our own state, so a
// larger difference means that it has not heard us yet, or does not mean this arm.
constexpr double kAlignDistance = 1e-6;  // [m]
constexpr double kAlignAngle = 1e-6;     // [rad]

bool aligned(const MasterState& master, const MotionState& motion) {
  return valid_command(master) && standing(motion) &&
         (master.X_SU.p - motion.X_ST.p).norm() < kAlignDistance &&
         angle_between(master.X_SU.q, motion.X_ST.q) < kAlignAngle;
}

bool stop_stands(const FollowInput& in) {
  return in.master_known && kept(Check::kStopEpoch) &&
         in.master.stop_epoch != in.master.released_epoch;
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
    s.surface.forget();
  }
}

// The commands of one cycle, through the guard; returns what intervened.
Reason move_once(const FollowSettings& settings, const FollowInput& in, FollowState& s,
                 FollowLedger& ledger) {
  const bool following = follows(s.session);
  const Led led = following ? lead(settings, in, s, ledger)
                            : Led{brake(settings.motion, s.motion), Reason::kNone};
  const Verdict safe = command(settings.motion, led.next, s.motion);
  if (safe.reason == Reason::kNone) return led.why;
  ++s.guarded;
  if (following) {
    put_stage(ledger, FollowStage::kLimits,
              ledger.off_S.col(static_cast<int>(FollowStage::kLimits)).cast<double>() +
                  s.motion.X_ST.p - led.next.X_ST.p,
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

// What a cycle has found out.
struct Found {
  JointVector q_measured = JointVector::Zero();
  Pose X_ST;  // measured
  Reason sensor = Reason::kNone, fault = Reason::kNone, obstacle = Reason::kNone;
  Reason intervention = Reason::kNone;
};

// A gripper moves only while the arm may. A gap in the link changes nothing about it. Where nobody
// leads, nothing is said of it: its outputs stay as they are, and somebody at the controller is not
// worked against.
Grip gripped(Grip wanted, const FollowState& s) {
  if (follows(s.session)) return wanted;
  return s.session == SessionState::kHold ? s.grip : Grip::kAsItIs;
}

// For the master, but for the ledger.
void fill_link(const FollowSettings& settings, const FollowInput& in, const Found& found,
               const FollowState& s, SlaveState& link) {
  // A contact that is held because nothing is known of it is the sensor's doing.
  const bool blind = found.intervention == Reason::kBumper && found.sensor != Reason::kNone;
  link.state = s.session;
  link.fault = s.fault;
  link.reason = s.session == SessionState::kFault               ? s.fault
                : s.session_reason != Reason::kNone             ? s.session_reason
                : found.intervention != Reason::kNone && !blind ? found.intervention
                                                                : found.sensor;
  link.X_ST_command = s.motion.X_ST;
  link.X_ST = found.X_ST;
  link.has_pose = s.placed && in.robot_ready && is_finite(link.X_ST);
  link.q_measured = found.q_measured;
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
                                                   : found.fault;
  link.obstacle = follows(s.session) || s.session == SessionState::kHold ? Reason::kNone
                  : still != Reason::kNone                               ? still
                                                                         : found.obstacle;
  link.position_tool_epoch = s.tube.position_epoch();
  link.orientation_tool_epoch = s.tube.orientation_epoch();
  link.oldest_applied = s.oldest_applied;
  link.cycles = s.cycles;
  link.applied_sequence = s.applied_sequence;
  link.surface = s.surface.surface();
  link.gripper = in.gripper;
  link.hashes = settings.hashes;
  link.hashes.tools = s.tube.hash();
  link.scene = settings.scene;
}

}  // namespace

bool released(const FollowInput& in, const FollowState& state) noexcept {
  const bool seen = in.master.fault_reset == state.fault_epoch || !kept(Check::kResetSeen);
  return state.session == SessionState::kFault && in.master_known && in.link.confirmed &&
         !stop_stands(in) && seen;
}

void place(const FollowSettings& settings, const JointVector& q, FollowState& state) noexcept {
  state.motion = standing_at(settings.motion->arm, q);
  state.joints = JointMonitor();
  state.following.restart(q);
  state.lag.restart(q);
  state.bumper = BumperState();
  state.surface.forget();
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
  Found found;
  found.q_measured = answered ? s.joints.judge(in.q_measured) : s.joints.newest();
  found.X_ST = forward(settings.motion->arm, found.q_measured);
  found.sensor = read_force(settings, in, found.X_ST, s);
  if (found.sensor != Reason::kNone) s.surface.forget();
  if (s.placed) s.lag.add(s.motion.joints.q, found.q_measured, settings.motion->dt);
  const Reason contact = judge_contact(settings, found.X_ST.p, s);
  FollowLedger& ledger = out.link.ledger;
  ledger = FollowLedger();
  found.fault = judge_arm(settings, in, found.q_measured, s, ledger.joint);
  // An arm that somebody else has moved does not drive back by itself.
  if (s.session == SessionState::kOff) s.elsewhere = -1;
  const bool moved = s.elsewhere >= 0 && s.session != SessionState::kFault;
  if (found.fault == Reason::kNone && moved) found.fault = Reason::kEncoderInvalid;
  if (found.fault != Reason::kNone) s.lag.restart(found.q_measured);
  const bool needs_sensor = settings.sensor_required && follows(s.session);
  if (found.fault == Reason::kNone && needs_sensor) found.fault = found.sensor;
  if (found.fault == Reason::kNone && follows(s.session)) found.fault = contact;
  found.obstacle = settings.sensor_required ? found.sensor : Reason::kNone;
  advance_session(settings, in, s, found.fault, found.obstacle);
  out.grip = s.grip = gripped(in.master.grip, s);
  found.intervention = move_commands(settings, in, s, ledger, out.send);
  out.q_target = s.placed ? s.motion.joints.q : found.q_measured;
  if (s.fault == Reason::kEncoderInvalid && s.elsewhere >= 0) {
    ledger.joint = static_cast<std::int8_t>(s.elsewhere);
  }
  fill_link(settings, in, found, s, out.link);
}

}  // namespace handrail
