#include "server/haptic/ledger.h"

namespace handrail {
namespace {

// What moves a stage by less is rounding [m].
constexpr double kNothing = 1e-6;

Vec3 finite_or_none(const Vec3& f) { return is_finite(f) ? f : Vec3(Vec3::Zero()); }

MotionStage stage_of(FollowStage stage, Reason why) {
  switch (stage) {
    case FollowStage::kTube: return MotionStage::kTube;
    case FollowStage::kBumper: return MotionStage::kBumper;
    case FollowStage::kReach: return MotionStage::kReach;
    case FollowStage::kLimits:
    case FollowStage::kCount: break;
  }
  return why == Reason::kSingularity ? MotionStage::kSingularity : MotionStage::kLimits;
}

}  // namespace

ForceLedger account(const ForceShares& shares, const Vec3& tool, const Vec3& walls,
                    const Vec3& spring, const Vec3& governor, const Vec3& cue) noexcept {
  ForceLedger out;
  out.tool = finite_or_none(tool);
  out.walls = finite_or_none(walls);
  out.spring = finite_or_none(spring);
  out.clamp = shares.peak_took;
  out.cue = cue;
  out.device = shares.device;
  out.governor = finite_or_none(governor);
  out.limits = out.device - out.tool - out.walls - out.spring - out.governor - out.clamp - out.cue;
  return out;
}

void account(const Pose& X_SH, const Guidance& guidance, const SlaveState& slave,
             MotionLedger& out) noexcept {
  const Vec3& p_SU = guidance.X_SC.p;
  const Vec3 smoothed = p_SU - guidance.X_SP.p;
  // Mostly the easing of a tool change, else the mean of the last samples.
  const bool eased = 4.0 * guidance.offset.squaredNorm() > smoothed.squaredNorm();
  const auto put = [&out](MotionStage stage, const Vec3& off, Reason why) {
    out.off_S.col(static_cast<int>(stage)) = off;
    out.why[static_cast<std::size_t>(stage)] =
        off.squaredNorm() > kNothing * kNothing ? why : Reason::kNone;
  };
  put(MotionStage::kTool, guidance.X_SP.p - X_SH.p, Reason::kToolTube);
  put(MotionStage::kSmoother, smoothed, eased ? Reason::kToolBlending : Reason::kNone);
  // The slave's last stage is one of these two.
  put(MotionStage::kLimits, Vec3::Zero(), Reason::kNone);
  put(MotionStage::kSingularity, Vec3::Zero(), Reason::kNone);
  Vec3 there = Vec3::Zero();
  for (int i = 0; i < FollowLedger::kStages; ++i) {
    const Reason why = slave.ledger.why[static_cast<std::size_t>(i)];
    const Vec3 off = slave.ledger.off_S.col(i).cast<double>();
    put(stage_of(static_cast<FollowStage>(i), why), off, why);
    there += off;
  }
  // What neither side's stages explain is on its way.
  put(MotionStage::kLink, slave.X_ST_command.p - p_SU - there,
      slave.state == SessionState::kEngaged ? Reason::kNone : slave.reason);
  out.q_SH = X_SH.q;
  out.q_SP = guidance.X_SP.q;
  out.q_SU = guidance.X_SC.q;
  out.q_ST = slave.X_ST_command.q;
  out.eased_angle = guidance.offset_angle;
  out.known = true;
}

}  // namespace handrail
