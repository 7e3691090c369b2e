#include "server/haptic/haptic_step.h"

#include <algorithm>
#include <numbers>

#include "server/base/deletable.h"
#include "server/haptic/haptic_lead.h"
#include "server/haptic/tool_orders.h"

namespace handrail {
namespace {

// Torque per radian falls to zero between these angles: at half a turn the direction back flips.
constexpr double kTorqueFull = 2.6;             // [rad]
constexpr double kHalfTurn = std::numbers::pi;  // [rad]

// What the session has just come to, for the hand to feel.
Cue news_of(SessionState before, const HapticState& s) {
  const bool led = may_drive(before) || before == SessionState::kClutched;
  if (!led || s.lead.session == before) return Cue::kNone;
  if (s.lead.session == SessionState::kHold) return Cue::kHold;
  const bool lost = s.lead.session == SessionState::kFault && s.lead.reason == Reason::kLinkLost;
  return lost ? Cue::kLost : Cue::kNone;
}

// The cue's force this tick, frame M, smaller where the device has no room for all of it.
Vec3 play_cue(const HapticSettings& settings, const HapticInput& in, SessionState before,
              const HapticOutput& out, bool hand_ok, double dt, HapticState& s) {
  if (!hand_ok) {
    s.force.cue.cut(news_of(before, s));
    return Vec3::Zero();
  }
  const Cue lasting = s.force.kept_back.step(out.motion, in.slave.X_ST_command.p, dt);
  const double force = s.force.cue.step(
      news_of(before, s), s.lead.session == SessionState::kEngaged ? lasting : Cue::kNone, dt);
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
      std::min(s.command.guide.torque_stiffness(settings.guide) * usable, settings.max_torque);
  return s.command.engagement.turn_to_hand(twist_pull) * (size / angle);
}

// Torque comes and goes at most at full scale per fade time, as force does. Beside it, it follows
// the hand by `follows` [N m]: a spring that came after the hand would make energy.
Vec3 limited_torque(const HapticSettings& settings, const Vec3& last, Vec3 wanted, double follows,
                    double dt) {
  if (!is_finite(wanted)) wanted.setZero();
  const double allowed = settings.max_torque * dt / settings.force.fade_out + follows;
  const Vec3 change = wanted - last;
  const double size = change.norm();
  return size > allowed ? Vec3(last + change * (allowed / size)) : wanted;
}

std::uint32_t tool_epochs(const HapticState& s) {
  return s.command.guide.position().definition().epoch +
         s.command.guide.orientation().definition().epoch;
}

void fill_link(const HapticSettings& settings, const HapticState& s, MasterState& link) {
  const bool clutched = s.lead.session == SessionState::kClutched ||
                        (may_drive(s.lead.session) && !s.command.driving);
  link.desired = !s.lead.want_engaged ? Desired::kOff
                 : clutched           ? Desired::kClutched
                                      : Desired::kEngaged;
  link.state = s.lead.session;
  link.X_SU = s.command.X_SU;
  link.has_command = s.command.has_command;
  link.stop_epoch = s.lead.stop_epoch;
  link.released_epoch = s.lead.released_epoch;
  link.fault_reset = s.lead.fault_reset;
  link.engagement_epoch = s.lead.engagement_epoch;
  link.grip = s.lead.grip;
  link.position_tool = s.command.guide.position().definition();
  link.orientation_tool = s.command.guide.orientation().definition();
  link.hashes = settings.hashes;
  link.hashes.tools = s.command.tools_hash;
  link.scene = settings.scene;
}

// How far the hand moved since the last tick, frame M.
struct Moved {
  Vec3 by = Vec3::Zero();      // [m]
  Vec3 turn = Vec3::Zero();    // rotation vector [rad]
  Vec3 faster = Vec3::Zero();  // [m/s]
};

// Takes over the hand's reading if it is one. `turns`: the turn is asked for, too. After too long
// without one the hand does not drive.
Moved hear_hand(const HapticInput& in, bool ok, bool turns, double dt, HandTrack& track,
                bool& driving) {
  Moved moved;
  const HandReading& hand = in.hand;
  if (!ok) {
    track.gap.goes_on(dt, in.unseen);
    return moved;
  }
  if (track.gap.ends(dt, in.unseen)) driving = false;
  if (track.known) moved.by = hand.X_MH.p - track.X_MH.p;
  if (track.known) moved.faster = hand.v_MH - track.v_MH;
  if (track.known && turns) moved.turn = rotation_log(hand.X_MH.q * track.X_MH.q.conjugate());
  track.X_MH = hand.X_MH;
  track.v_MH = hand.v_MH;
  track.known = true;
  return moved;
}

// What whoever called the tool hears of it. The command has yet to move.
void tell_tool(const HapticOrder& order, const Guide& guide, HapticOutput& out) {
  if (order.kind != OrderKind::kTool) return;
  const bool position = is_position_tool(order.tool.kind);
  out.tool_id = (position ? guide.position().definition() : guide.orientation().definition()).id;
  if (guide.turning() && !position) {
    out.tool_angle = guide.orientation().deviation(guide.command().q);
  }
}

// Orders, presence and session of this tick.
void decide(const HapticSettings& settings, const HapticInput& in, const LadderStep& ladder,
            double dt, HapticState& s, HapticOutput& out) {
  const std::uint32_t epochs_before = tool_epochs(s);
  see_presence(settings, in, dt, s);
  out.tool_distance = out.hand_latched = out.tool_angle = 0.0;
  out.tool_id = 0;
  out.order_result = Reason::kNone;
  if (in.order.kind != OrderKind::kNone) {
    const Vec3 before = s.command.engagement.to_slave(s.hand.X_MH).p;
    out.order_result = carry_out(settings, in, ladder, s, out.tool_distance);
    if (out.order_result == Reason::kNone) tell_tool(in.order, s.command.guide, out);
    if (out.order_result == Reason::kHandElsewhere) {
      const HandOff off = hand_off(settings, s, in.slave.X_ST_command);
      out.tool_distance = off.distance;
      out.tool_angle = off.angle;
    }
    out.hand_latched = (s.command.engagement.to_slave(s.hand.X_MH).p - before).norm();
  }
  if (in.hand.drop_button && !s.hand.button_was_down) drop_tools(settings, true, true, s);
  s.hand.button_was_down = in.hand.drop_button;
  advance_session(settings, in, ladder, dt, s);
  if (tool_epochs(s) != epochs_before) {
    s.command.tools_hash = tools_hash(s.command.guide.position().definition(),
                                      s.command.guide.orientation().definition());
  }
}

// What tool and arm ask for on the hand, frame M [N], [N m].
struct Wanted {
  Vec3 tool = Vec3::Zero(), spring = Vec3::Zero(), torque = Vec3::Zero();
  Vec3 tool_spring = Vec3::Zero();  // of `tool`, without its damper
  double torque_stiffness = 0.0;    // [N m/rad]
  Vec3 surface = Vec3::Zero();      // that the tip touches
  double stiffness = 0.0;           // the stiffer of tool and surface [N/m]
  double surface_stiffness = 0.0;   // [N/m]
  double damping = 0.0;             // of the tool [N s/m]

  // What is left where the link or the arm's state is in doubt. `holds`: the arm stands where the
  // tip touches the surface, which pushes by where the hand is, not by what is told: it stays.
  // Of an engagement that has ended nothing stays.
  Wanted in_doubt(bool holds) const {
    Wanted left;
    if (!holds) return left;
    left.surface = surface;
    left.stiffness = left.surface_stiffness = surface_stiffness;
    return left;
  }
};

// The surface in place of what of the spring is along it or across the tool.
void render_surface(const HapticSettings& settings, const HapticInput& in, const Guidance& guidance,
                    double dt, HapticState& s, Wanted& wanted, HapticOutput& out) {
  if (settings.surface_stiffness == 0.0) return;
  LocalSurfaceInput touched;
  if (in.slave.has_pose) touched.told = in.slave.surface;
  // The command as it will be when the smoother has come after.
  touched.p_SU = guidance.X_SP.p + guidance.offset;
  touched.p_ST = in.slave.X_ST.p;
  touched.f_E_S = in.slave.f_E_S.force;
  touched.has_force = in.slave.has_wrench;
  touched.scale = settings.mapping.scale;
  touched.most_stiffness = settings.surface_stiffness;
  const LocalSurfaceForce felt = s.force.surface.step(touched, dt);
  if (felt.why != Reason::kNone) out.reasons.add(felt.why);
  // It pushes the tip, whose tool bears what is across it: of push and spring the hand feels what
  // is along the tool. All of them would make energy on a way around, as where the tip is does not
  // say where the hand is.
  const PositionTool& tool = s.command.guide.position();
  const Engagement& engagement = s.command.engagement;
  const Vec3 n_S = tool.along(felt.n_S), off_S = in.slave.X_ST.p - s.command.X_SU.p;
  wanted.surface = felt.push * engagement.turn_to_hand(n_S);
  const Vec3 beside_S = tool.along(off_S) - off_S.dot(n_S) * n_S;
  wanted.spring +=
      felt.share * (settings.spring_stiffness * engagement.to_hand(beside_S) - wanted.spring);
  wanted.surface_stiffness = felt.stiffness;
  // Neither adds to the other, as they are at right angles.
  if (felt.stiffness > 0.0)
    wanted.stiffness = tool.active() ? std::max(felt.stiffness, wanted.stiffness) : felt.stiffness;
}

// The command by the hand, and what that is to feel like.
Wanted lead_tip(const HapticSettings& settings, const HapticInput& in, bool hand_ok, double dt,
                HapticState& s, HapticOutput& out) {
  Wanted wanted;
  out.deviation = out.deviation_angle = 0.0;
  out.blending = false;
  out.motion.known = false;
  out.motion.joint = in.slave.ledger.joint;  // of its fault or obstacle, whoever drives
  CommandState& command = s.command;
  wanted.stiffness = command.guide.stiffness(settings.guide);
  if (!command.driving) {
    s.force.surface.forget();
    return wanted;
  }
  const Pose X_SH = command.engagement.to_slave(s.hand.X_MH);
  // While the arm holds nothing is eased: it would have to run after that.
  const double easing = s.lead.session == SessionState::kHold ? 0.0 : dt;
  const Guidance guidance = command.guide.step(settings.guide, X_SH, easing);
  command.X_SU = guidance.X_SC;
  if (guidance.beyond) out.reasons.add(Reason::kOutOfReach);
  const Vec3 pull_M = command.engagement.to_hand(guidance.pull);
  wanted.tool = command.guide.stiffness(settings.guide) * pull_M;  // (3.4)
  wanted.tool_spring = wanted.tool;
  if (command.guide.position().active() && hand_ok) {
    wanted.damping = settings.damping;
    wanted.tool -= settings.damping * in.hand.v_MH;
  }
  // (3.3), against the command before the bumper, so that contact is felt.
  wanted.spring =
      settings.spring_stiffness * command.engagement.to_hand(in.slave.X_ST.p - command.X_SU.p);
  render_surface(settings, in, guidance, dt, s, wanted, out);
  wanted.torque = torque_of(settings, s, guidance.twist_pull);
  wanted.torque_stiffness = command.guide.torque_stiffness(settings.guide);
  out.blending = guidance.blending;
  out.deviation = command.guide.position().active() ? pull_M.norm() : 0.0;
  if (in.slave.has_pose) account(X_SH, guidance, in.slave, out.motion);
  out.deviation_angle = command.guide.orientation().deviation(X_SH.q);
  if (guidance.blending) out.reasons.add(Reason::kToolBlending);
  return wanted;
}

// What the governor makes of tool, spring and torque, and what it says.
struct GovernedForces {
  Governed tool, spring, torque;
};

GovernedForces govern(const HapticSettings& settings, const HapticInput& in, const Wanted& wanted,
                      double force_share, const Moved& moved, double dt, ForceState& s) {
  const bool missed = in.hand.force_missed;
  const RenderedForce tool{force_share * (wanted.tool + wanted.surface),
                           force_share * (wanted.tool_spring + wanted.surface),
                           force_share * wanted.stiffness};
  GovernedForces out;
  out.tool = s.governor.govern(settings.governor, tool, moved.by, dt, missed);
  out.spring = s.tank.govern(settings.governor, force_share * wanted.spring,
                             settings.spring_stiffness, moved.by, dt, missed, out.tool.used);
  if (!settings.has_torque) return out;
  const Vec3 torque = force_share * wanted.torque;
  out.torque = s.turn_governor.govern(settings.turn_governor,
                                      {torque, torque, force_share * wanted.torque_stiffness},
                                      moved.turn, dt, missed);
  return out;
}

// The device's force and torque. `moved`: of the hand in this tick; `trust`: in what is
// wanted, the rest leaves fast; `before`: the session in the last tick.
void give_force(const HapticSettings& settings, const HapticInput& in, const Wanted& wanted,
                double force_share, const Moved& moved, bool hand_ok, Trust trust,
                SessionState before, double dt, HapticState& s, HapticOutput& out) {
  if (!hand_ok) s.force.cut();
  const bool trusted = trust == Trust::kBoth;
  const Wanted given = trusted ? wanted : wanted.in_doubt(trust == Trust::kTool);
  const GovernedForces governed = govern(settings, in, given, force_share, moved, dt, s.force);
  out.energy_made = governed.tool.made + governed.torque.made;
  // A damper that came after the hand by its step limit alone would push it on.
  const double follows = given.stiffness * moved.by.norm() + given.damping * moved.faster.norm();
  out.shares = s.force.arbiter.share(settings.force, governed.tool.force, governed.spring.force,
                                     follows, trust, dt);
  // What the step limit left of a force that was to be gone counts where it can be taken back.
  const Vec3 spring = governed.tool.force.isZero(0.0) ? out.shares.device : out.shares.spring;
  s.force.governor.told(out.shares.device - spring);
  s.force.tank.told(spring);
  const Vec3 cue = play_cue(settings, in, before, out, hand_ok, dt, s);
  out.shares.device += cue;
  out.shares.limited += cue;
  const Vec3 taken = governed.tool.force - force_share * (given.tool + given.surface) +
                     governed.spring.force - force_share * given.spring;
  out.force = account(out.shares, wanted.tool, wanted.surface, wanted.spring, taken, cue);
  out.f_H_M.force = out.shares.device;
  out.f_H_M.torque = s.force.torque =
      limited_torque(settings, s.force.torque, governed.torque.force,
                     given.torque_stiffness * moved.turn.norm(), dt);
  s.force.turn_governor.told(s.force.torque);
  if (governed.tool.acted || governed.spring.acted || governed.torque.acted)
    out.reasons.add(Reason::kForceEnergy);
  if (out.shares.clamped) out.reasons.add(Reason::kForceClamped);
  if (out.shares.thermal) out.reasons.add(Reason::kForceContinuous);
  if (out.shares.budget) out.reasons.add(Reason::kForceBudget);
  if (out.shares.stepped) out.reasons.add(Reason::kForceRate);
  if (s.lead.session != SessionState::kOff && (!trusted || force_share < 1.0))
    out.reasons.add(Reason::kForceFaded);
}

}  // namespace

void haptic_step(const HapticSettings& settings, const HapticInput& in, double dt, HapticState& s,
                 HapticOutput& out) noexcept {
  out.reasons = ReasonSet();
  const bool hand_ok = in.hand.valid && is_place(in.hand.X_MH) && is_finite(in.hand.v_MH) &&
                       in.hand.v_MH.cwiseAbs().maxCoeff() <= kFastestHand;
  if (!hand_ok) out.reasons.add(Reason::kDeviceInvalid);
  const Moved moved = hear_hand(in, hand_ok, settings.has_torque, dt, s.hand, s.command.driving);
  const Nanos slave_age = age_after(in.unseen, in.slave_age);
  const LadderStep ladder = ladder_step(settings.ladder, in.slave_known, slave_age, in.link,
                                        std::max(dt, to_seconds(in.unseen)), s.ladder);
  out.link_shares = ladder.shares;
  out.link_window = settings.ladder.good_for;
  const SessionState before = s.lead.session;
  decide(settings, in, ladder, dt, s, out);
  const Wanted wanted = lead_tip(settings, in, hand_ok, dt, s, out);
  // No force while the hand does not drive; and where its reading, the link or the slave's state is
  // not to be trusted, what there is leaves fast.
  const bool engaged = s.lead.session == SessionState::kEngaged;
  const bool holds = s.lead.session == SessionState::kHold;
  const bool told = !engaged || (in.slave.has_pose && is_place(in.slave.X_ST));
  const Trust trust = !hand_ok || !told || s.lead.session == SessionState::kFault ? Trust::kNone
                      : holds                                                     ? Trust::kTool
                                                                                  : Trust::kBoth;
  out.turning = s.command.guide.turning();
  give_force(settings, in, wanted, ladder.force_share, moved, hand_ok, trust, before, dt, s, out);

  out.reason = s.lead.reason;
  if (engaged && !s.command.driving) out.reason = Reason::kDeviceInvalid;
  if (s.lead.session == SessionState::kClutched) {
    if (s.lead.hand_elsewhere) out.reason = Reason::kHandElsewhere;
    if (!s.lead.present) out.reason = Reason::kPresence;
  }
  out.peer_fault = s.lead.peer_fault;
  out.reasons.add(out.reason);
  if (s.lead.want_engaged && ladder.old_loop) out.reasons.add(Reason::kLoopAge);
  if (ladder.rung != rung_of(in.slave_known, slave_age)) out.reasons.add(Reason::kLinkQuality);
  out.obstacle =
      s.lead.session == SessionState::kOff     ? obstacle_to_engaging(settings, in, ladder, s)
      : s.lead.session == SessionState::kFault ? obstacle_after_reset(settings, in, ladder, s)
                                               : Reason::kNone;
  fill_link(settings, s, out.link);
}

}  // namespace handrail
