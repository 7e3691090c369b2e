#include "server/master/why_report.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <utility>

#include "server/base/units.h"
#include "server/master/set_vector.h"
#include "server/master/status_report.h"
#include "server/master/way_out.h"

namespace handrail {
namespace {

constexpr double kWorthSaying = 0.2;       // [mm] or [deg]
constexpr double kForceWorthSaying = 0.1;  // chosen: about the least that a hand notices [N]
// Parts at a right angle to each other add up to 1.4 times their sum as vectors.
constexpr double kCancels = 1.5;

constexpr std::array<const char*, MotionLedger::kStages> kStageNames = {
    "tool", "smoother", "link", "tube", "bumper", "reach", "limits", "singularity"};

// What one stage did, for people.
struct Share {
  MotionStage stage = MotionStage::kTool;
  Reason why = Reason::kNone;
  double mm = 0.0, deg = 0.0;
  double size() const { return std::max(mm, deg); }
};
using Shares = std::array<Share, MotionLedger::kStages>;

void set_force(pb::ForceShare* out, const Vec3& force) {
  out->set_magnitude_n(force.norm());
  set_vector(out->mutable_force_n(), force, 1.0);
}

// Which stage turned the tip away from the command: the one that the slave says acts, else the
// link.
Share slave_turn(const SlaveState& slave) {
  constexpr std::pair<FollowStage, MotionStage> kOrder[] = {
      {FollowStage::kLimits, MotionStage::kLimits},
      {FollowStage::kReach, MotionStage::kReach},
      {FollowStage::kTube, MotionStage::kTube}};
  for (const auto& [theirs, ours] : kOrder) {
    const Reason why = slave.ledger.why[static_cast<std::size_t>(theirs)];
    if (why == Reason::kNone) continue;
    return {why == Reason::kSingularity ? MotionStage::kSingularity : ours, why};
  }
  return {MotionStage::kLink};
}

Shares shares_of(const MotionLedger& ledger, const SlaveState& slave, bool old_loop) {
  Shares shares;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    shares[i].stage = static_cast<MotionStage>(i);
    shares[i].why = ledger.why[i];
    shares[i].mm = ledger.off_S.col(static_cast<Eigen::Index>(i)).norm() / kMm;
  }
  const auto turned = [&shares](Share by, double angle) {
    Share& share = shares[static_cast<std::size_t>(by.stage)];
    share.deg = angle / kDeg;
    if (share.deg >= std::max(kWorthSaying, share.mm)) share.why = by.why;
  };
  const double smoothed = angle_between(ledger.q_SP, ledger.q_SU);
  turned({MotionStage::kTool, Reason::kToolTube}, angle_between(ledger.q_SH, ledger.q_SP));
  turned({MotionStage::kSmoother,
          2.0 * ledger.eased_angle > smoothed ? Reason::kToolBlending : Reason::kNone},
         smoothed);
  turned(slave_turn(slave), angle_between(ledger.q_SU, ledger.q_ST));
  Share& link = shares[static_cast<std::size_t>(MotionStage::kLink)];
  // It looks as if it were still on its way.
  if (link.why == Reason::kNone && slave.reason == Reason::kRobotSilent) link.why = slave.reason;
  if (link.why == Reason::kNone && old_loop) link.why = Reason::kLoopAge;
  return shares;
}

// What the slave has, and the controller does not take, is the controller's.
const char* stage_name(const Share& share) {
  if (share.why == Reason::kRobotSilent) return "controller";
  return kStageNames[static_cast<std::size_t>(share.stage)];
}

const char* reason_text(const Share& share) {
  const bool smooths = share.stage == MotionStage::kSmoother && share.why == Reason::kNone;
  return smooths && share.size() > 0.0 ? "smoothing" : describe(share.why);
}

// Why the arm holds; kNone while it follows the hand.
Reason holding(const HapticReport& report, const SlaveState& slave, const LinkSnapshot& link,
               Nanos now) {
  if (now > report.good_until) return Reason::kThreadStalled;
  if (report.walls.present) return Reason::kNoArmInScene;
  const HapticOutput& out = report.out;
  if (link.refused(now)) return Reason::kOtherMaster;
  if (out.link.state == SessionState::kEngaged && slave.state == SessionState::kEngaged) {
    return out.motion.known ? Reason::kNone : out.reason;
  }
  if (out.link.state == SessionState::kClutched) {
    return out.reason == Reason::kNone ? Reason::kClutched : out.reason;
  }
  // What would refuse an engage does so whether anybody has tried or not: the slave's own first, as
  // it knows more of it.
  const bool idle = out.link.state == SessionState::kOff && link.age(now) <= kHeardLately;
  const bool in_fault = idle && slave.state == SessionState::kFault;
  const Reason fault = out.reason == Reason::kPeerFault ? out.peer_fault
                       : in_fault                       ? slave.fault
                                                        : Reason::kNone;
  if (fault != Reason::kNone) return fault;
  // A bad moment of a bad link is no news of its own.
  const bool moment = out.obstacle == Reason::kLinkQuality &&
                      (slave.reason == Reason::kLinkStale || slave.reason == Reason::kLinkHold);
  const bool says_why = slave.reason != Reason::kNone && slave.reason != Reason::kNotEngaged;
  if (idle && says_why && !moment) return slave.reason;
  if (out.link.state == SessionState::kOff && out.obstacle != Reason::kNone) return out.obstacle;
  if (out.reason == Reason::kHoming && slave.reason != Reason::kNone) return slave.reason;
  if (out.reason != Reason::kNone) return out.reason;
  if (link.peer_epoch == 0) return Reason::kNoPeer;
  return slave.reason != Reason::kNone ? slave.reason : Reason::kNotEngaged;
}

// A stop or a lost link on top of what is still wrong: a reset alone meets that again. kNone where
// a reset and an engage suffice.
Reason still_wrong(const HapticReport& report, const SlaveState& slave, const LinkSnapshot& link,
                   Nanos now) {
  if (report.walls.present) return Reason::kNone;
  if (link.age(now) <= kHeardLately) {
    if (slave.obstacle != Reason::kNone) return slave.obstacle;
    const bool says_why = slave.state == SessionState::kOff && slave.reason != Reason::kNotEngaged;
    if (says_why && slave.reason != Reason::kNone) return slave.reason;
  }
  return report.out.obstacle == Reason::kPeerFault ? Reason::kNone : report.out.obstacle;
}

// "11.8 mm and 0.3 deg"; what is not worth saying is left out, but never all.
std::string amount(double mm, double deg) {
  const bool turned = deg >= kWorthSaying;
  std::string far = fmt::format("{:.1f} mm", mm);
  if (!turned) return far;
  return (mm >= kWorthSaying ? far + " and " : "") + fmt::format("{:.1f} deg", deg);
}

// "11.8 mm limits: joint acceleration limit (J1)"
std::string stage_text(const Share& share, int joint, const LinkSnapshot& link, Nanos now) {
  std::string out = amount(share.mm, share.deg) + " ";
  if (share.stage == MotionStage::kSmoother) return out + reason_text(share);
  out += stage_name(share);
  if (share.why != Reason::kNone) out += fmt::format(": {}", describe(share.why));
  if (share.stage >= MotionStage::kReach && joint >= 0) out += fmt::format(" (J{})", joint + 1);
  if (share.stage == MotionStage::kLink && share.why != Reason::kRobotSilent &&
      link.loop_age(now) != kForever) {
    out += fmt::format(" (loop {} ms)", link.loop_age(now) / kMillisecond);
  }
  return out;
}

// "; the hand feels 0.4 N less: force lowered so that it makes no energy"
std::string governed_text(const ForceLedger& force) {
  const double less = force.governor.norm();
  if (less < kForceWorthSaying) return "";
  return fmt::format("; the hand feels {:.1f} N less: {}", less, describe(Reason::kForceEnergy));
}

void add_order(WayOutOrder order, pb::Ledger& out) {
  pb::Request& request = *out.add_way_out_order();
  switch (order) {
    case WayOutOrder::kTakeLease: request.mutable_lease()->set_act(pb::LeaseOrder::TAKE); break;
    case WayOutOrder::kReset: request.set_reset(true); break;
    case WayOutOrder::kEngage: request.set_engage(true); break;
    case WayOutOrder::kClutchOff: request.set_clutch(false); break;
  }
}

void set_sentence(pb::Ledger* out, const HapticReport& report, const SlaveState& slave,
                  const LinkSnapshot& link, Shares shares, Nanos now) {
  const MotionLedger& ledger = report.out.motion;
  // What the slave said before another led it says nothing of how it will be found.
  const bool slave_latched = slave.state == SessionState::kFault && !link.refused(now);
  const SessionState state = report.out.link.state;
  const Stand stand = state == SessionState::kFault || slave_latched ? Stand::kLatched
                      : state == SessionState::kOff                  ? Stand::kOff
                                                                     : Stand::kLed;
  const auto set_way_out = [&](Reason why) {
    out->set_way_out(way_out_of(why, ledger.joint, slave.q_measured, stand));
    for (const WayOutOrder order : orders_out_of(why, stand)) add_order(order, *out);
  };
  // In a scene of walls there is no arm to hold, nor to engage. Only a stop takes the walls away.
  if (report.walls.present && report.out.link.stop_epoch != report.out.link.released_epoch) {
    out->set_sentence("the walls are not felt: a stop was requested");
    out->set_way_out("reset");
    return add_order(WayOutOrder::kReset, *out);
  }
  if (const Reason why = holding(report, slave, link, now); why != Reason::kNone) {
    const auto said = [&](Reason reason) -> std::string {
      if (reason == Reason::kOtherMaster) return other_master_text(link, now);
      if (reason == Reason::kLinkQuality) return link_quality_text(report.out, link, now);
      if (reason == Reason::kDeviceInvalid) return reason_text(reason, report);
      return describe(reason);
    };
    std::string text = "the arm holds: " + said(why);
    const Reason still = stand == Stand::kLatched ? still_wrong(report, slave, link, now) : why;
    // What a reset releases is no second trouble.
    const std::string first = way_out_of(still, ledger.joint, slave.q_measured, stand);
    const bool two = still != Reason::kNone && still != why && why != Reason::kOtherMaster &&
                     first != "reset, then engage";
    if (two) text += "; and " + said(still);
    out->set_sentence(text);
    return set_way_out(two ? still : why);
  }
  if (!ledger.known) {
    out->set_sentence("the hand does not lead the arm yet");
    return;
  }
  std::stable_sort(shares.begin(), shares.end(),
                   [](const Share& a, const Share& b) { return a.size() > b.size(); });
  std::string text = "the arm is " + amount(out->behind_mm(), out->behind_deg()) + " from the hand";
  const auto cancels = [&shares](double Share::*size, double behind) {
    double parts = 0.0;
    for (const Share& share : shares) parts += share.*size >= kWorthSaying ? share.*size : 0.0;
    return parts > kCancels * behind + kWorthSaying;
  };
  const bool cancel =
      cancels(&Share::mm, out->behind_mm()) || cancels(&Share::deg, out->behind_deg());
  const char* separator = cancel ? ", as these partly cancel: " : ": ";
  for (const Share& share : shares) {
    if (share.size() < kWorthSaying) break;
    text += separator + stage_text(share, ledger.joint, link, now);
    separator = "; ";
  }
  out->set_sentence(text + governed_text(report.out.force));
  if (shares[0].size() >= kWorthSaying) set_way_out(shares[0].why);
}

}  // namespace

void set_ledger(pb::Ledger* out, const HapticReport& report, const SlaveState& slave,
                const LinkSnapshot& link, Nanos now) {
  // What is not known is nothing.
  const MotionLedger ledger = report.out.motion.known ? report.out.motion : MotionLedger();
  const Shares shares = shares_of(ledger, slave, report.out.reasons.has(Reason::kLoopAge));
  out->set_behind_mm(ledger.off_S.rowwise().sum().norm() / kMm);
  out->set_behind_deg(angle_between(ledger.q_SH, ledger.q_ST) / kDeg);
  set_sentence(out, report, slave, link, shares, now);
  for (const Share& share : shares) {
    const auto at = static_cast<Eigen::Index>(share.stage);
    pb::MotionShare* stage = out->add_motion();
    stage->set_stage(stage_name(share));
    stage->set_mm(share.mm);
    stage->set_deg(share.deg);
    set_vector(stage->mutable_offset_mm(), ledger.off_S.col(at), kMm);
    stage->set_reason(reason_text(share));
  }
  out->set_joint(static_cast<std::uint32_t>(ledger.joint + 1));
  const ForceLedger& force = report.out.force;
  set_force(out->mutable_tool(), force.tool);
  set_force(out->mutable_walls(), force.walls);
  set_force(out->mutable_spring(), force.spring);
  set_force(out->mutable_governor(), force.governor);
  set_force(out->mutable_limits(), force.limits);
  set_force(out->mutable_clamp(), force.clamp);
  set_force(out->mutable_cue(), force.cue);
  set_force(out->mutable_device(), force.device);
  out->set_energy_made_mj(1e3 * report.out.energy_made);
}

}  // namespace handrail
