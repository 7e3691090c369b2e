#include "server/haptic/haptic_lead.h"

#include <algorithm>

#include "server/base/deletable.h"
#include "server/haptic/tool_orders.h"

namespace handrail {
namespace {

// Homing and aligning take no longer.
constexpr double kLongestAligning = 10.0;  // [s], chosen: an operator waits no longer
// A slave silent for longer is lost: what it said last is no fault that an operator sees.
constexpr Nanos kInSight = 200 * kMillisecond;

// The hand may not lead an arm that stands at `X_ST`.
bool elsewhere(const HapticSettings& settings, const HapticState& s, const Pose& X_ST) {
  if (!settings.mapping.absolute) return false;
  const HandOff off = hand_off(settings, s, X_ST);
  return !(off.distance <= kAgree && off.angle <= kAgreeTurned);
}

// The slave holds another definition of a tool it says it has taken.
bool tools_differ(const HapticState& s, const SlaveState& slave) {
  return slave.position_tool_epoch == s.command.guide.position().definition().epoch &&
         slave.orientation_tool_epoch == s.command.guide.orientation().definition().epoch &&
         slave.hashes.tools != s.command.tools_hash;
}

Reason reset(HapticState& s, const HapticInput& in) {
  const bool peer_fault = in.slave_known && in.slave.state == SessionState::kFault;
  if (s.lead.session != SessionState::kFault && !s.lead.stop_latched() && !peer_fault) {
    return Reason::kNotStopped;
  }
  s.lead.released_epoch = s.lead.stop_epoch;
  if (in.slave_known && in.slave_age <= kInSight) s.lead.fault_reset = in.slave.fault_epoch;
  s.lead.want_engaged = s.lead.want_clutched = false;
  s.lead.off_reason = Reason::kNotEngaged;
  return Reason::kNone;
}

// No hand, or no link good enough to know the slave by.
Reason obstacle_of_link(const HapticInput& in, const LadderStep& ladder, const HapticState& s) {
  if (!s.hand.known || s.hand.gap.too_long()) return Reason::kDeviceInvalid;
  if (ladder.rung == LinkRung::kHold) return Reason::kLinkQuality;
  if (ladder.rung != LinkRung::kFresh && ladder.rung != LinkRung::kSlow) {
    return reason_of(ladder.rung);
  }
  if (!in.link.confirmed) return Reason::kNotConfirmed;
  return ladder.good ? Reason::kNone : Reason::kLinkQuality;
}

MasterSessionInput session_input(const HapticSettings& settings, const HapticInput& in,
                                 const LadderStep& ladder, bool clutched, const HapticState& s) {
  MasterSessionInput session;
  // Without a hand there is nothing to engage.
  session.desired = !s.lead.want_engaged || !s.hand.known ? Desired::kOff
                    : clutched                            ? Desired::kClutched
                                                          : Desired::kEngaged;
  session.link = ladder.rung;
  session.confirmed = in.link.confirmed;
  session.ready = in.device_ready;
  session.overdue = s.lead.aligning_for >= kLongestAligning;
  session.peer = in.slave.state;
  session.same_engagement = in.slave.engagement_epoch == s.lead.engagement_epoch;
  session.obstacle = in.slave.obstacle;
  session.mismatch = first_difference(settings, in.slave);
  session.stop_latched = s.lead.stop_latched();
  session.reset = in.order.kind == OrderKind::kReset;
  return session;
}

// What the session's step means for what the operator wants, and for what is said of it.
void note_session(const HapticInput& in, const MasterSessionInput& session, const SessionStep& next,
                  double dt, LeadState& lead) {
  const SessionState before = lead.session;
  lead.session = next.state;
  const bool stays_in_fault = next.state == SessionState::kFault && before == SessionState::kFault;
  if (!stays_in_fault) lead.peer_fault = in.slave.fault;
  const auto waits = [](SessionState state) {
    return state == SessionState::kHoming || state == SessionState::kAligning;
  };
  const bool waiting = waits(lead.session);
  if (waiting && !waits(before)) ++lead.engagement_epoch;
  lead.aligning_for = waiting ? lead.aligning_for + dt : 0.0;
  // The first cause of a fault stays, unless the operator's stop comes on top.
  if (!stays_in_fault || next.reason == Reason::kStopRequested) lead.reason = next.reason;
  if (next.state == SessionState::kFault || next.state == SessionState::kOff) {
    lead.want_engaged = lead.want_clutched = false;
    // A grip left over would close the gripper at the next engagement, on whatever is there then.
    lead.grip = Grip::kAsItIs;
  }
  if (next.state == SessionState::kOff) {
    if (session.overdue || next.reason == session.obstacle) lead.off_reason = next.reason;
    if (next.reason == Reason::kNotEngaged) lead.reason = lead.off_reason;
  }
}

// Where the command stands, and whether the hand moves it, as the session is now.
void place_command(const HapticSettings& settings, const HapticInput& in, bool clutched,
                   HapticState& s) {
  if (s.lead.session == SessionState::kAligning) {
    // The command is the pose the slave already stands on: taking over moves nothing.
    s.command.has_command = in.slave.has_pose && is_place(in.slave.X_ST_command);
    if (s.command.has_command) {
      s.command.X_SU = in.slave.X_ST_command;
      // Tools may be called before the hand first drives, with the clutch held: anchored here.
      s.command.guide.restart(settings.guide, s.command.X_SU);
    }
  }
  if (s.lead.session == SessionState::kOff || s.lead.session == SessionState::kFault) {
    // A tool left over would pull the arm at the next engagement, with the hand still.
    drop_tools(settings, true, true, s);
  }
  const bool driving = may_drive(s.lead.session) && !clutched && !s.hand.gap.too_long();
  if (driving && !s.command.driving) {
    const Pose X_SH = s.command.guide.restart(settings.guide, s.command.X_SU);
    // The way to a reference takes the hand to be turned as that wants.
    s.command.engagement = settings.mapping.absolute && !s.command.guide.turning()
                               ? Engagement::absolute(settings.mapping)
                               : Engagement(settings.mapping, s.hand.X_MH, X_SH);
  }
  const bool lets_go = s.command.driving && !driving;
  s.command.driving = driving;
  // Whoever lets go of the arm, or holds the clutch, stops an approach, and the way to a reference:
  // they do not go on by themselves.
  if (lets_go) {
    drop_tools(settings, s.command.guide.approaching(), s.command.guide.turning(), s);
  }
}

}  // namespace

HandOff hand_off(const HapticSettings& settings, const HapticState& s, const Pose& X_ST) noexcept {
  const Pose asked = Engagement::absolute(settings.mapping).to_slave(s.hand.X_MH);
  return {(asked.p - X_ST.p).norm(), angle_between(asked.q, X_ST.q)};
}

void begin_epochs(std::uint64_t unique, HapticState& state) noexcept {
  if (!kept(Check::kEpochs)) return;
  state.lead.stop_epoch = state.lead.released_epoch = state.lead.engagement_epoch = unique;
}

Reason obstacle_after_reset(const HapticSettings& settings, const HapticInput& in,
                            const LadderStep& ladder, const HapticState& s) noexcept {
  if (const Reason link = obstacle_of_link(in, ladder, s); link != Reason::kNone) return link;
  if (in.slave.obstacle != Reason::kNone) return in.slave.obstacle;
  if (tools_differ(s, in.slave)) return Reason::kHashTools;
  const Reason difference = first_difference(settings, in.slave);
  if (difference != Reason::kNone) return difference;
  if (in.slave.has_pose && elsewhere(settings, s, in.slave.X_ST_command)) {
    return Reason::kHandElsewhere;
  }
  return s.lead.present ? Reason::kNone : Reason::kPresence;  // last: given while engaging
}

// Refused is refused: a wish that waited for the obstacle to go would engage out of the blue. While
// another leads the slave nothing that is done here helps, so that is said first.
Reason obstacle_to_engaging(const HapticSettings& settings, const HapticInput& in,
                            const LadderStep& ladder, const HapticState& s) noexcept {
  if (in.link.other_master) return Reason::kOtherMaster;
  if (s.lead.stop_latched()) return Reason::kStopRequested;
  if (s.lead.session == SessionState::kFault) return s.lead.reason;
  if (const Reason unheard = obstacle_of_link(in, ladder, s); unheard != Reason::kNone)
    return unheard;
  if (in.slave.state == SessionState::kFault) return Reason::kPeerFault;
  return obstacle_after_reset(settings, in, ladder, s);
}

Reason carry_out(const HapticSettings& settings, const HapticInput& in, const LadderStep& ladder,
                 HapticState& s, double& tool_distance) noexcept {
  switch (in.order.kind) {
    case OrderKind::kNone: return Reason::kNone;
    case OrderKind::kEngage: {
      if (!settings.has_arm) return Reason::kNoArmInScene;
      const Reason obstacle = obstacle_to_engaging(settings, in, ladder, s);
      if (obstacle == Reason::kNone) {
        s.lead.want_engaged = true;
        s.lead.off_reason = Reason::kNotEngaged;
      }
      return obstacle;
    }
    case OrderKind::kDisengage:
      s.lead.want_engaged = s.lead.want_clutched = false;
      s.lead.off_reason = in.order.why;
      return Reason::kNone;
    case OrderKind::kClutchOn:
    case OrderKind::kClutchOff:
      if (!s.lead.want_engaged) return Reason::kNotEngaged;
      s.lead.want_clutched = in.order.kind == OrderKind::kClutchOn;
      return Reason::kNone;
    case OrderKind::kStop:
      ++s.lead.stop_epoch;
      s.lead.want_engaged = s.lead.want_clutched = false;
      return Reason::kNone;
    case OrderKind::kReset: return reset(s, in);
    case OrderKind::kStage:
    case OrderKind::kScrew:
      // One that exists is set by whoever runs the walls.
      return Reason::kNoSuchStage;
    case OrderKind::kGrip:
      if (!follows(s.lead.session)) return Reason::kNotEngaged;
      s.lead.grip = in.order.grip;
      return Reason::kNone;
    case OrderKind::kTool:
      // Without an engagement there is no place to anchor at or to start from.
      if (!follows(s.lead.session)) return Reason::kNotEngaged;
      return call_tool(settings, in.order.tool,
                       in.slave.has_pose ? in.slave.X_ST_command.p : s.command.X_SU.p, s,
                       tool_distance);
    case OrderKind::kToolOff:
      return drop_tools(settings, in.order.drop_position, in.order.drop_orientation, s);
  }
  return Reason::kNone;
}

void see_presence(const HapticSettings& settings, const HapticInput& in, double dt,
                  HapticState& s) noexcept {
  s.lead.present =
      !kept(Check::kPresence) ||
      present(settings.presence, in.hand.valid && in.hand.enable_button, in.hold_heard);
  s.lead.absent_for = s.lead.present ? 0.0 : std::min(s.lead.absent_for + dt, kAbsence);
  if (s.lead.want_engaged && s.lead.absent_for >= kAbsence) {
    s.lead.want_engaged = s.lead.want_clutched = false;
    s.lead.off_reason = Reason::kPresence;
  }
}

void advance_session(const HapticSettings& settings, const HapticInput& in,
                     const LadderStep& ladder, double dt, HapticState& s) noexcept {
  s.lead.hand_elsewhere =
      s.command.has_command && !s.command.driving && elsewhere(settings, s, s.command.X_SU);
  const bool clutched =
      s.lead.want_clutched || in.hand.clutch_button || !s.lead.present || s.lead.hand_elsewhere;
  const MasterSessionInput session = session_input(settings, in, ladder, clutched, s);
  note_session(in, session, next_master(s.lead.session, session), dt, s.lead);
  place_command(settings, in, clutched, s);
}

}  // namespace handrail
