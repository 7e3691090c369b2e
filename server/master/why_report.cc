#include "server/master/why_report.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <utility>

#include "server/base/units.h"
#include "server/kinematics/rv2a.h"
#include "server/master/status_report.h"

namespace handrail {
namespace {

constexpr double kWorthSaying = 0.2;  // [mm] or [deg]
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

void set_vector(google::protobuf::RepeatedField<double>* out, const Vec3& v, double unit) {
  for (int i = 0; i < 3; ++i) out->Add(v[i] / unit);
}

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
  // What the slave has, and the controller does not take, looks as if it were still on its way.
  if (link.why == Reason::kNone && slave.reason == Reason::kRobotSilent) link.why = slave.reason;
  if (link.why == Reason::kNone && old_loop) link.why = Reason::kLoopAge;
  return shares;
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
  const bool idle = out.link.state == SessionState::kOff && link.age(now) <= kHeard;
  const bool in_fault = idle && slave.state == SessionState::kFault;
  if ((out.reason == Reason::kPeerFault || in_fault) && slave.fault != Reason::kNone) {
    return slave.fault;
  }
  const bool says_why = slave.reason != Reason::kNone && slave.reason != Reason::kNotEngaged;
  if (idle && says_why) return slave.reason;
  if (out.obstacle != Reason::kNone) return out.obstacle;
  if (out.reason != Reason::kNone) return out.reason;
  if (link.peer_epoch == 0) return Reason::kNoPeer;
  return slave.reason != Reason::kNone ? slave.reason : Reason::kNotEngaged;
}

// "11.8 mm and 0.3 deg"; what is not worth saying is left out, but never all.
std::string amount(double mm, double deg) {
  const bool turned = deg >= kWorthSaying;
  const std::string far = fmt::format("{:.1f} mm", mm);
  if (!turned) return far;
  return (mm >= kWorthSaying ? far + " and " : "") + fmt::format("{:.1f} deg", deg);
}

// "11.8 mm limits: joint acceleration limit (J1)"
std::string stage_text(const Share& share, int joint, const LinkSnapshot& link, Nanos now) {
  std::string out = amount(share.mm, share.deg) + " ";
  if (share.stage == MotionStage::kSmoother) return out + reason_text(share);
  out += share.why == Reason::kRobotSilent ? "controller"
                                           : kStageNames[static_cast<std::size_t>(share.stage)];
  if (share.why != Reason::kNone) out += fmt::format(": {}", describe(share.why));
  if (share.stage >= MotionStage::kReach && joint >= 0) out += fmt::format(" (J{})", joint + 1);
  if (share.stage == MotionStage::kLink && share.why != Reason::kRobotSilent &&
      link.loop_age(now) != kForever) {
    out += fmt::format(" (loop {} ms)", link.loop_age(now) / kMillisecond);
  }
  return out;
}

void set_sentence(pb::Ledger* out, const HapticReport& report, const SlaveState& slave,
                  const LinkSnapshot& link, Shares shares, Nanos now) {
  const MotionLedger& ledger = report.out.motion;
  // What the slave said before another led it says nothing of how it will be found.
  const bool slave_latched = slave.state == SessionState::kFault && !link.refused(now);
  const bool latched = report.out.link.state == SessionState::kFault || slave_latched;
  const auto set_way_out = [&](Reason why) {
    out->set_way_out(way_out_of(why, ledger.joint, slave.q_measured, latched));
  };
  // In a scene of walls there is no arm to hold, nor to engage.
  if (report.walls.present && report.out.link.state == SessionState::kFault) {
    out->set_sentence("the walls are not felt: a stop was requested");
    out->set_way_out("reset");
    return;
  }
  if (const Reason why = holding(report, slave, link, now); why != Reason::kNone) {
    out->set_sentence(fmt::format("the arm holds: {}", why == Reason::kOtherMaster
                                                           ? other_master_text(link, now)
                                                           : describe(why)));
    return set_way_out(why);
  }
  if (!ledger.known) {
    out->set_sentence("the hand does not lead the arm yet");
    return;
  }
  std::stable_sort(shares.begin(), shares.end(),
                   [](const Share& a, const Share& b) { return a.size() > b.size(); });
  std::string text = "the arm is " + amount(out->behind_mm(), out->behind_deg()) + " from the hand";
  double parts = 0.0;
  for (const Share& share : shares) parts += share.mm >= kWorthSaying ? share.mm : 0.0;
  const bool cancel = parts > kCancels * out->behind_mm() + kWorthSaying;
  const char* separator = cancel ? ", as these partly cancel: " : ": ";
  for (const Share& share : shares) {
    if (share.size() < kWorthSaying) break;
    text += separator + stage_text(share, ledger.joint, link, now);
    separator = "; ";
  }
  out->set_sentence(text);
  if (shares[0].size() >= kWorthSaying) set_way_out(shares[0].why);
}

// Out of the singular configuration that the arm is nearest to, each by what counts as near.
const char* way_out_of_singularity(const JointVector& q) {
  constexpr double kNearSine = 0.1, kNearAxis = 0.020;  // [m]
  const SingularityMargin margin = singularity_margin(ArmGeometry(), q);
  const double wrist = margin.wrist / kNearSine, shoulder = margin.shoulder / kNearAxis;
  if (margin.elbow / kNearSine < std::min(wrist, shoulder)) return "come back toward the base";
  return wrist <= shoulder ? "tilt the tip away from the forearm's axis"
                           : "move out from the base axis";
}

}  // namespace

std::string way_out_of(Reason reason, int joint, const JointVector& q, bool latched) {
  const std::string then = latched ? "then reset and engage" : "then engage";
  switch (reason) {
    case Reason::kNotEngaged:
      return "engage";
    case Reason::kStopRequested:
    case Reason::kLinkLost:
    case Reason::kPeerFault:  // of a slave that has been started anew since
    case Reason::kFollowingError:
      return latched ? "reset, then engage" : "engage";
    case Reason::kRobotLost:
    case Reason::kRobotNotConnected:
      return "at the controller: clear its alarm, if there is one, and start its program in "
             "AUTOMATIC; the slave's log names other causes; " +
             then;
    case Reason::kRobotSilent:
      return "wait, or move slower";
    case Reason::kEncoderInvalid:
      return joint >= 0 ? fmt::format("look at J{}, which reads {:.1f} deg; {}", joint + 1,
                                      q[joint] / kDeg, then)
                        : "look at the encoders; " + then;
    case Reason::kSensorStuck:
    case Reason::kSensorInvalid:
    case Reason::kSensorMissing:
    case Reason::kSensorSign:
    case Reason::kContactUnrelieved:
      return "check the force sensor, " + then;
    case Reason::kHashTools:
    case Reason::kHashMapping:
    case Reason::kHashLimits:
    case Reason::kHashRobot:
    case Reason::kSceneDiffers:
    case Reason::kSceneNotLoaded:
      return "give both sides the same scene and version, " + then;
    case Reason::kDeviceInvalid:
      return "check the haptic device, then engage";
    case Reason::kNoArmInScene:
      return "load a scene with an arm: 'handrail scene load NAME'";
    case Reason::kNoPeer:
      return "start the slave, or check the network, then engage";
    case Reason::kSessionClosed:
      return "start the slave if it does not run, " + then;
    case Reason::kLinkStale:
    case Reason::kLinkHold:
    case Reason::kLinkQuality:
    case Reason::kNotConfirmed:
      return "wait for the link, or move slower";
    case Reason::kLoopAge:
      return "move slower: what you see is old";
    case Reason::kOtherMaster:
      return "end that master: then the slave takes this one, without a restart; " + then;
    case Reason::kClutched:
      return "let the clutch go";
    case Reason::kPresence:
      return "hold the enabling button, or keep 'handrail engage --hold' running";
    case Reason::kLeaseLost:
      return "take the lease and engage: 'handrail lease take'";
    case Reason::kStopInput:
      return "close the stop circuit, " + then;
    case Reason::kOutOfReach:
    case Reason::kWorkspace:
      return "come back toward the base";
    case Reason::kJointRange:
      return joint >= 0 ? fmt::format("turn J{} back", joint + 1) : "turn back";
    case Reason::kSingularity:
      return way_out_of_singularity(q);
    case Reason::kJointSpeed:
    case Reason::kJointAcceleration:
    case Reason::kJointJerk:
    case Reason::kTipSpeed:
    case Reason::kApproach:
      return "wait, or move slower";
    case Reason::kToolBlending:
      return "wait";
    case Reason::kBumper:
      return "move away from the contact";
    default:
      return {};
  }
}

void set_ledger(pb::Ledger* out, const HapticReport& report, const SlaveState& slave,
                const LinkSnapshot& link, Nanos now) {
  // What is not known is nothing.
  const MotionLedger ledger = report.out.motion.known ? report.out.motion : MotionLedger();
  const Shares shares = shares_of(ledger, slave, report.out.reasons.has(Reason::kLoopAge));
  out->set_behind_mm(ledger.off_S.rowwise().sum().norm() / kMm);
  out->set_behind_deg(angle_between(ledger.q_SH, ledger.q_ST) / kDeg);
  set_sentence(out, report, slave, link, shares, now);
  for (const Share& share : shares) {
    const int at = static_cast<int>(share.stage);
    pb::MotionShare* stage = out->add_motion();
    stage->set_stage(kStageNames[static_cast<std::size_t>(at)]);
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
  set_force(out->mutable_clamp(), force.clamp);
  set_force(out->mutable_cue(), force.cue);
  set_force(out->mutable_device(), force.device);
}

}  // namespace handrail
