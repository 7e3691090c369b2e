#include "server/haptic/haptic_step.h"

#include <algorithm>

#include "server/base/deletable.h"
#include "server/haptic/tool_orders.h"

namespace handrail {
namespace {

// Torque per radian falls to zero between these angles: at half a turn the direction back flips.
constexpr double kTorqueFull = 2.6;  // [rad]
constexpr double kHalfTurn = 3.14159265358979323846;
constexpr double kFastest = 100.0;  // nor does a hand move like this [m/s]
// A hand silent for longer takes over again like after a clutch, wherever it comes back [s].
constexpr double kLongestGap = 0.020;
// Homing and aligning take no longer [s].
constexpr double kLongestAligning = 10.0;
// A slave silent for longer is lost: what it said last is no fault that an operator sees.
constexpr Nanos kInSight = 200 * kMillisecond;

// The slave holds another definition of a tool it says it has taken.
bool tools_differ(const HapticState& s, const SlaveState& slave) {
  return slave.position_tool_epoch == s.guide.position().definition().epoch &&
         slave.orientation_tool_epoch == s.guide.orientation().definition().epoch &&
         slave.hashes.tools != s.tools_hash;
}

// The hand may move the command; in hold the arm catches up when the link comes back.
bool may_drive(SessionState state) {
  return state == SessionState::kEngaged || state == SessionState::kHold;
}

bool stop_latched(const HapticState& s) { return s.stop_epoch != s.released_epoch; }

Reason reset(HapticState& s, const HapticInput& in) {
  const bool peer_fault = in.slave_known && in.slave.state == SessionState::kFault;
  if (s.session != SessionState::kFault && !stop_latched(s) && !peer_fault) {
    return Reason::kNotStopped;
  }
  s.released_epoch = s.stop_epoch;
  if (in.slave_known && in.slave_age <= kInSight) s.fault_reset = in.slave.fault_epoch;
  s.want_engaged = s.want_clutched = false;
  s.off_reason = Reason::kNotEngaged;
  return Reason::kNone;
}

// No hand, or no link good enough to know the slave by.
Reason obstacle_of_link(const HapticInput& in, const LadderStep& ladder, const HapticState& s) {
  if (!s.hand_known || s.hand_gap > kLongestGap) return Reason::kDeviceInvalid;
  if (ladder.rung == LinkRung::kHold) return Reason::kLinkQuality;
  if (ladder.rung != LinkRung::kFresh && ladder.rung != LinkRung::kSlow) {
    return reason_of(ladder.rung);
  }
  if (!in.link.confirmed) return Reason::kNotConfirmed;
  return ladder.held_good ? Reason::kNone : Reason::kLinkQuality;
}

// What would refuse an engage once a reset has released what is latched on both sides.
Reason obstacle_after_reset(const HapticSettings& settings, const HapticInput& in,
                            const LadderStep& ladder, const HapticState& s) {
  if (const Reason link = obstacle_of_link(in, ladder, s); link != Reason::kNone) return link;
  if (in.slave.obstacle != Reason::kNone) return in.slave.obstacle;
  if (tools_differ(s, in.slave)) return Reason::kHashTools;
  const Reason difference = first_difference(settings, in.slave);
  if (difference != Reason::kNone) return difference;
  return s.present ? Reason::kNone : Reason::kPresence;  // last: given while engaging
}

// Refused is refused: a wish that waited for the obstacle to go would engage out of the blue. While
// another leads the slave nothing that is done here helps, so that is said first.
Reason obstacle_to_engaging(const HapticSettings& settings, const HapticInput& in,
                            const LadderStep& ladder, const HapticState& s) {
  if (in.link.other_master) return Reason::kOtherMaster;
  if (stop_latched(s)) return Reason::kStopRequested;
  if (s.session == SessionState::kFault) return s.session_reason;
  if (const Reason unheard = obstacle_of_link(in, ladder, s); unheard != Reason::kNone)
    return unheard;
  if (in.slave.state == SessionState::kFault) return Reason::kPeerFault;
  return obstacle_after_reset(settings, in, ladder, s);
}

Reason carry_out(const HapticSettings& settings, const HapticInput& in, const LadderStep& ladder,
                 HapticState& s, double& tool_distance) {
  switch (in.order.kind) {
    case OrderKind::kNone:
      return Reason::kNone;
    case OrderKind::kEngage: {
      if (!settings.has_arm) return Reason::kNoArmInScene;
      const Reason obstacle = obstacle_to_engaging(settings, in, ladder, s);
      if (obstacle == Reason::kNone) {
        s.want_engaged = true;
        s.off_reason = Reason::kNotEngaged;
      }
      return obstacle;
    }
    case OrderKind::kDisengage:
      s.want_engaged = s.want_clutched = false;
      s.off_reason = in.order.why;
      return Reason::kNone;
    case OrderKind::kClutchOn:
    case OrderKind::kClutchOff:
      if (!s.want_engaged) return Reason::kNotEngaged;
      s.want_clutched = in.order.kind == OrderKind::kClutchOn;
      return Reason::kNone;
    case OrderKind::kStop:
      ++s.stop_epoch;
      s.want_engaged = s.want_clutched = false;
      return Reason::kNone;
    case OrderKind::kReset:
      return reset(s, in);
    case OrderKind::kStage:
      // One that exists is set by whoever runs the walls.
      return Reason::kNoSuchStage;
    case OrderKind::kTool:
      // Without an engagement there is no place to anchor at or to start from.
      if (!may_drive(s.session) && s.session != SessionState::kClutched) {
        return Reason::kNotEngaged;
      }
      return call_tool(settings, in.order.tool,
                       in.slave.has_pose ? in.slave.X_ST_command.p : s.X_SU.p, s, tool_distance);
    case OrderKind::kToolOff:
      return drop_tools(settings, in.order.drop_position, in.order.drop_orientation, s);
  }
  return Reason::kNone;
}

// Nobody there is as good as a clutch held; for long, the engagement ends.
void see_presence(const HapticSettings& settings, const HapticInput& in, double dt,
                  HapticState& s) {
  s.present = !kept(Check::kPresence) ||
              present(settings.presence, in.hand.valid && in.hand.enable_button, in.hold_heard);
  s.absent_for = s.present ? 0.0 : std::min(s.absent_for + dt, kAbsence);
  if (s.want_engaged && s.absent_for >= kAbsence) {
    s.want_engaged = s.want_clutched = false;
    s.off_reason = Reason::kPresence;
  }
}

void advance_session(const HapticSettings& settings, const HapticInput& in,
                     const LadderStep& ladder, double dt, HapticState& s) {
  MasterSessionInput session;
  const bool clutched = s.want_clutched || in.hand.clutch_button || !s.present;
  // Without a hand there is nothing to engage.
  session.desired = !s.want_engaged || !s.hand_known ? Desired::kOff
                    : clutched                       ? Desired::kClutched
                                                     : Desired::kEngaged;
  session.link = ladder.rung;
  session.confirmed = in.link.confirmed;
  session.ready = in.device_ready;
  session.overdue = s.aligning_for >= kLongestAligning;
  session.peer = in.slave.state;
  session.same_engagement = in.slave.engagement_epoch == s.engagement_epoch;
  session.obstacle = in.slave.obstacle;
  session.mismatch = first_difference(settings, in.slave);
  session.stop_latched = stop_latched(s);
  session.reset = in.order.kind == OrderKind::kReset;

  const SessionState before = s.session;
  const SessionStep next = next_master(before, session);
  s.session = next.state;
  if (next.state != SessionState::kFault || before != SessionState::kFault) {
    s.peer_fault = in.slave.fault;
  }
  const auto waits = [](SessionState state) {
    return state == SessionState::kHoming || state == SessionState::kAligning;
  };
  const bool waiting = waits(s.session);
  if (waiting && !waits(before)) ++s.engagement_epoch;
  s.aligning_for = waiting ? s.aligning_for + dt : 0.0;
  // The first cause of a fault stays, unless the operator's stop comes on top.
  if (next.state != SessionState::kFault || before != SessionState::kFault ||
      next.reason == Reason::kStopRequested) {
    s.session_reason = next.reason;
  }
  if (next.state == SessionState::kFault || next.state == SessionState::kOff) {
    s.want_engaged = s.want_clutched = false;
  }
  if (next.state == SessionState::kOff) {
    if (session.overdue || next.reason == session.obstacle) s.off_reason = next.reason;
    if (next.reason == Reason::kNotEngaged) s.session_reason = s.off_reason;
  }

  if (s.session == SessionState::kAligning) {
    // The command is the pose the slave already stands on: taking over moves nothing.
    s.has_command = in.slave.has_pose && is_place(in.slave.X_ST_command);
    if (s.has_command) {
      s.X_SU = in.slave.X_ST_command;
      // Tools may be called before the hand first drives, with the clutch held: anchored here.
      s.guide.restart(settings.guide, s.X_SU);
    }
  }
  if (s.session == SessionState::kOff || s.session == SessionState::kFault) {
    // A tool left over would pull the arm at the next engagement, with the hand still.
    drop_tools(settings, true, true, s);
  }
  const bool driving = may_drive(s.session) && !clutched && s.hand_gap <= kLongestGap;
  if (driving && !s.driving) {
    s.engagement = Engagement(settings.mapping, s.X_MH, s.X_SU);
    s.guide.restart(settings.guide, s.X_SU);
  }
  s.driving = driving;
  // Whoever lets go of the arm, or holds the clutch, stops an approach: it does not go on by
  // itself.
  if (!driving && s.guide.approaching()) drop_tools(settings, true, false, s);
}

// What the session has just come to, for the hand to feel.
Cue news_of(SessionState before, const HapticState& s) {
  const bool led = may_drive(before) || before == SessionState::kClutched;
  if (!led || s.session == before) return Cue::kNone;
  if (s.session == SessionState::kHold) return Cue::kHold;
  const bool lost = s.session == SessionState::kFault && s.session_reason == Reason::kLinkLost;
  return lost ? Cue::kLost : Cue::kNone;
}

// The cue's force this tick, frame M, smaller where the device has no room for all of it.
Vec3 play_cue(const HapticSettings& settings, const HapticInput& in, SessionState before,
              const HapticOutput& out, double dt, HapticState& s) {
  const Cue lasting = s.kept_back.step(out.motion, in.slave.X_ST_command.p, dt);
  const double force = s.cue.step(news_of(before, s),
                                  s.session == SessionState::kEngaged ? lasting : Cue::kNone, dt);
  const double room = settings.force.peak - out.shares.device.norm();
  return {0.0, 0.0, force * std::clamp(room / kLargestCue, 0.0, 1.0)};
}

Vec3 torque_of(const HapticSettings& settings, const HapticState& s, const Vec3& twist_pull) {
  const double angle = twist_pull.norm();
  if (!settings.has_torque || angle == 0.0) return Vec3::Zero();
  const double usable =
      angle <= kTorqueFull
          ? angle
          : kTorqueFull * std::max(0.0, (kHalfTurn - angle) / (kHalfTurn - kTorqueFull));
  // (3.5), (3.6): stiffness times angle about the way back.
  const double size =
      std::min(s.guide.torque_stiffness(settings.guide) * usable, settings.max_torque);
  return s.engagement.turn_to_hand(twist_pull) * (size / angle);
}

// Torque comes and goes at most at full scale per fade time, as force does.
Vec3 limited_torque(const HapticSettings& settings, const Vec3& last, Vec3 wanted, double dt) {
  if (!is_finite(wanted)) wanted.setZero();
  const double allowed = settings.max_torque * dt / settings.force.fade_out;
  const Vec3 change = wanted - last;
  const double size = change.norm();
  return size > allowed ? Vec3(last + change * (allowed / size)) : wanted;
}

std::uint32_t tool_epochs(const HapticState& s) {
  return s.guide.position().definition().epoch + s.guide.orientation().definition().epoch;
}

void fill_link(const HapticSettings& settings, const HapticState& s, MasterState& link) {
  const bool clutched =
      s.session == SessionState::kClutched || (may_drive(s.session) && !s.driving);
  link.desired = !s.want_engaged ? Desired::kOff
                 : clutched      ? Desired::kClutched
                                 : Desired::kEngaged;
  link.state = s.session;
  link.X_SU = s.X_SU;
  link.has_command = s.has_command;
  link.stop_epoch = s.stop_epoch;
  link.released_epoch = s.released_epoch;
  link.fault_reset = s.fault_reset;
  link.engagement_epoch = s.engagement_epoch;
  link.position_tool = s.guide.position().definition();
  link.orientation_tool = s.guide.orientation().definition();
  link.hashes = settings.hashes;
  link.hashes.tools = s.tools_hash;
  link.scene = settings.scene;
}

}  // namespace

void begin_epochs(std::uint64_t unique, HapticState& state) noexcept {
  if (!kept(Check::kEpochs)) return;
  state.stop_epoch = state.released_epoch = state.engagement_epoch = unique;
}

void haptic_step(const HapticSettings& settings, const HapticInput& in, double dt, HapticState& s,
                 HapticOutput& out) noexcept {
  out.reasons = ReasonSet();
  const bool hand_ok = in.hand.valid && is_place(in.hand.X_MH) && is_finite(in.hand.v_MH) &&
                       in.hand.v_MH.cwiseAbs().maxCoeff() <= kFastest;
  Vec3 hand_motion = Vec3::Zero();
  if (hand_ok) {
    if (s.hand_known) hand_motion = in.hand.X_MH.p - s.X_MH.p;
    s.X_MH = in.hand.X_MH;
    s.hand_known = true;
    s.hand_gap = 0.0;
  } else {
    s.hand_gap = std::min(s.hand_gap + dt, 1.0);
    out.reasons.add(Reason::kDeviceInvalid);
  }

  const std::uint32_t epochs_before = tool_epochs(s);
  const Nanos slave_age = age_after(in.unseen, in.slave_age);
  const LadderStep ladder =
      ladder_step(settings.ladder, in.slave_known, slave_age, in.link, dt, s.ladder);
  see_presence(settings, in, dt, s);
  out.tool_distance = 0.0;
  const Vec3 hand_before = s.engagement.to_slave(s.X_MH).p;
  out.order_result = carry_out(settings, in, ladder, s, out.tool_distance);
  out.hand_latched = (s.engagement.to_slave(s.X_MH).p - hand_before).norm();
  if (in.hand.drop_button && !s.button_was_down) drop_tools(settings, true, true, s);
  s.button_was_down = in.hand.drop_button;
  const SessionState before = s.session;
  advance_session(settings, in, ladder, dt, s);
  if (tool_epochs(s) != epochs_before) {
    s.tools_hash = tools_hash(s.guide.position().definition(), s.guide.orientation().definition());
  }

  Vec3 f_tool = Vec3::Zero();
  Vec3 f_spring = Vec3::Zero();
  Vec3 torque = Vec3::Zero();
  out.deviation = out.deviation_angle = 0.0;
  out.blending = false;
  out.motion.known = false;
  out.motion.joint = in.slave.ledger.joint;  // of its fault or obstacle, whoever drives
  if (s.driving) {
    const Pose X_SH = s.engagement.to_slave(s.X_MH);
    // While the arm holds nothing is eased: it would have to run after that.
    const double easing = s.session == SessionState::kHold ? 0.0 : dt;
    const Guidance guidance = s.guide.step(settings.guide, X_SH, easing);
    s.X_SU = guidance.X_SC;
    if (guidance.beyond) out.reasons.add(Reason::kOutOfReach);
    const Vec3 pull_M = s.engagement.to_hand(guidance.pull);
    f_tool = s.guide.stiffness(settings.guide) * pull_M;  // (3.4)
    if (s.guide.position().active() && hand_ok) f_tool -= settings.damping * in.hand.v_MH;
    // (3.3), against the command before the bumper, so that contact is felt.
    f_spring = settings.spring_stiffness * s.engagement.to_hand(in.slave.X_ST.p - s.X_SU.p);
    torque = ladder.force_share * torque_of(settings, s, guidance.twist_pull);
    out.blending = guidance.blending;
    out.deviation = s.guide.position().active() ? pull_M.norm() : 0.0;
    if (in.slave.has_pose) account(X_SH, guidance, in.slave, out.motion);
    out.deviation_angle = s.guide.orientation().deviation(X_SH.q);
    if (guidance.blending) out.reasons.add(Reason::kToolBlending);
  }

  // No force while the hand does not drive; and where its reading, the link or the slave's state is
  // not to be trusted, what there is leaves fast.
  const bool engaged = s.session == SessionState::kEngaged;
  const bool in_doubt = s.session == SessionState::kHold || s.session == SessionState::kFault ||
                        (engaged && !(in.slave.has_pose && is_place(in.slave.X_ST)));
  if (!hand_ok) s.arbiter.cut();
  out.shares = s.arbiter.share(
      settings.force, ladder.force_share * f_tool, ladder.force_share * f_spring,
      s.guide.stiffness(settings.guide) * hand_motion.norm(), hand_ok && !in_doubt, dt);
  const Vec3 cue = hand_ok ? play_cue(settings, in, before, out, dt, s) : Vec3(Vec3::Zero());
  out.shares.device += cue;
  out.shares.limited += cue;
  out.force = account(out.shares, f_tool, Vec3::Zero(), f_spring, cue);
  out.f_H_M.force = out.shares.device;
  out.f_H_M.torque = s.torque =
      limited_torque(settings, s.torque, hand_ok && !in_doubt ? torque : Vec3(Vec3::Zero()), dt);
  if (out.shares.clamped) out.reasons.add(Reason::kForceClamped);
  if (out.shares.thermal) out.reasons.add(Reason::kForceContinuous);
  if (out.shares.budget) out.reasons.add(Reason::kForceBudget);
  if (out.shares.stepped) out.reasons.add(Reason::kForceRate);
  if (s.session != SessionState::kOff && (in_doubt || ladder.force_share < 1.0))
    out.reasons.add(Reason::kForceFaded);

  out.reason = s.session_reason;
  if (engaged && !s.driving) out.reason = Reason::kDeviceInvalid;
  if (s.session == SessionState::kClutched && !s.present) out.reason = Reason::kPresence;
  out.peer_fault = s.peer_fault;
  out.reasons.add(out.reason);
  if (s.want_engaged && ladder.old_loop) out.reasons.add(Reason::kLoopAge);
  if (ladder.rung != rung_of(in.slave_known, slave_age)) out.reasons.add(Reason::kLinkQuality);
  out.obstacle = s.session == SessionState::kOff     ? obstacle_to_engaging(settings, in, ladder, s)
                 : s.session == SessionState::kFault ? obstacle_after_reset(settings, in, ladder, s)
                                                     : Reason::kNone;
  fill_link(settings, s, out.link);
}

}  // namespace handrail
