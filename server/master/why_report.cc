#include "server/master/why_report.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>

#include "server/base/units.h"

namespace handrail {
namespace {

constexpr double kWorthSaying = 0.2 * kMm;

constexpr std::array<const char*, MotionLedger::kStages> kStageNames = {
    "tool", "smoother", "link", "tube", "bumper", "reach", "limits", "singularity"};

void set_vector(google::protobuf::RepeatedField<double>* out, const Vec3& v, double unit) {
  for (int i = 0; i < 3; ++i) out->Add(v[i] / unit);
}

void set_force(pb::ForceShare* out, const Vec3& force) {
  out->set_magnitude_n(force.norm());
  set_vector(out->mutable_force_n(), force, 1.0);
}

double share(const MotionLedger& ledger, int stage) { return ledger.off_S.col(stage).norm(); }

// Why the arm holds; kNone while it follows the hand.
Reason holding(const HapticReport& report, const SlaveState& slave, const LinkSnapshot& link,
               Nanos now) {
  if (now > report.good_until) return Reason::kThreadStalled;
  if (report.walls.present) return Reason::kNoArmInScene;
  const HapticOutput& out = report.out;
  if (out.link.state == SessionState::kEngaged && slave.state == SessionState::kEngaged) {
    return Reason::kNone;
  }
  if (out.link.state == SessionState::kClutched) {
    return out.reason == Reason::kNone ? Reason::kClutched : out.reason;
  }
  if (out.reason == Reason::kPeerFault && slave.fault != Reason::kNone) return slave.fault;
  if (out.reason != Reason::kNone) return out.reason;
  if (link.peer_epoch == 0) return Reason::kNoPeer;
  return slave.reason != Reason::kNone ? slave.reason : Reason::kNotEngaged;
}

// "11.8 mm limits: joint acceleration limit (J1)"
std::string stage_text(const MotionLedger& ledger, int stage, const LinkSnapshot& link, Nanos now) {
  const auto at = static_cast<std::size_t>(stage);
  std::string out = fmt::format("{:.1f} mm {}", share(ledger, stage) / kMm, kStageNames[at]);
  if (ledger.why[at] != Reason::kNone) out += fmt::format(": {}", describe(ledger.why[at]));
  const auto what = static_cast<MotionStage>(stage);
  const bool joint = what == MotionStage::kLimits || what == MotionStage::kSingularity;
  if (joint && ledger.joint >= 0) out += fmt::format(" (J{})", ledger.joint + 1);
  if (what == MotionStage::kLink && link.loop_age(now) != kForever) {
    out += fmt::format(" (loop {} ms)", link.loop_age(now) / kMillisecond);
  }
  return out;
}

void set_sentence(pb::Ledger* out, const HapticReport& report, const SlaveState& slave,
                  const LinkSnapshot& link, Nanos now) {
  if (const Reason why = holding(report, slave, link, now); why != Reason::kNone) {
    out->set_sentence(fmt::format("the arm holds: {}", describe(why)));
    out->set_way_out(std::string(way_out_of(why)));
    return;
  }
  const MotionLedger& ledger = report.out.motion;
  if (!ledger.known) {
    out->set_sentence("the hand does not lead the arm yet");
    return;
  }
  std::array<int, MotionLedger::kStages> order{};
  for (int i = 0; i < MotionLedger::kStages; ++i) order[static_cast<std::size_t>(i)] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return share(ledger, a) > share(ledger, b); });
  const double behind = ledger.off_S.rowwise().sum().norm();
  std::string text = fmt::format("the arm is {:.1f} mm from the hand", behind / kMm);
  const char* separator = ": ";
  for (const int stage : order) {
    if (share(ledger, stage) < kWorthSaying) break;
    text += separator + stage_text(ledger, stage, link, now);
    separator = "; ";
  }
  out->set_sentence(text);
  if (share(ledger, order[0]) < kWorthSaying) return;
  out->set_way_out(std::string(way_out_of(ledger.why[static_cast<std::size_t>(order[0])])));
}

}  // namespace

std::string_view way_out_of(Reason reason) noexcept {
  switch (reason) {
    case Reason::kNotEngaged:
      return "engage";
    case Reason::kStopRequested:
    case Reason::kLinkLost:
    case Reason::kRobotLost:
    case Reason::kFollowingError:
    case Reason::kEncoderInvalid:
      return "reset, then engage";
    case Reason::kSensorStuck:
    case Reason::kSensorInvalid:
    case Reason::kSensorMissing:
      return "check the force sensor, then reset and engage";
    case Reason::kNoPeer:
    case Reason::kSessionClosed:
      return "start the slave, or check the network, then engage";
    case Reason::kLinkStale:
    case Reason::kLinkHold:
    case Reason::kLinkQuality:
    case Reason::kNotConfirmed:
      return "wait for the link, or move slower";
    case Reason::kLoopAge:
      return "move slower: what you see is old";
    case Reason::kClutched:
      return "let the clutch go";
    case Reason::kPresence:
      return "hold the enabling button, or keep 'handrail engage --hold' running";
    case Reason::kStopInput:
      return "close the stop circuit, then reset and engage";
    case Reason::kOutOfReach:
    case Reason::kWorkspace:
      return "come back toward the base";
    case Reason::kJointRange:
      return "turn the joint back";
    case Reason::kSingularity:
      return "tilt the tip off the forearm's axis, or move away from above the base";
    case Reason::kJointSpeed:
    case Reason::kJointAcceleration:
    case Reason::kJointJerk:
    case Reason::kTipSpeed:
      return "move slower";
    case Reason::kBumper:
      return "move away from the contact";
    default:
      return {};
  }
}

void set_ledger(pb::Ledger* out, const HapticReport& report, const SlaveState& slave,
                const LinkSnapshot& link, Nanos now) {
  const MotionLedger& ledger = report.out.motion;
  set_sentence(out, report, slave, link, now);
  out->set_behind_mm(ledger.off_S.rowwise().sum().norm() / kMm);
  for (int i = 0; i < MotionLedger::kStages; ++i) {
    const auto at = static_cast<std::size_t>(i);
    pb::MotionShare* stage = out->add_motion();
    stage->set_stage(kStageNames[at]);
    stage->set_mm(share(ledger, i) / kMm);
    set_vector(stage->mutable_offset_mm(), ledger.off_S.col(i), kMm);
    stage->set_reason(describe(ledger.why[at]));
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
