#include "server/lab/sequences/tip_stand_in.h"

#include <limits>

namespace handrail {
namespace {

constexpr double kServoLag = 0.02;   // of the tip behind its command [s]
constexpr double kAtCommand = 1e-9;  // [m]

// From `from` to `to`, no further than `way` [m] and `turn` [rad].
Pose toward(const Pose& from, const Pose& to, double way, double turn) {
  Pose out = to;
  const Vec3 d = to.p - from.p;
  const double size = d.norm();
  if (size > way) out.p = from.p + d * (way / size);
  const double angle = from.q.angularDistance(to.q);
  if (angle > turn) out.q = from.q.slerp(turn / angle, to.q).normalized();
  return out;
}

}  // namespace

TipStandIn::TipStandIn(Draw& draw) noexcept
    : late_(draw.chance(0.5) ? 1 : static_cast<std::size_t>(draw.below(kLatest))),
      speed_(draw.between(0.1, 1.0)),
      turning_(draw.between(0.5, 5.0)),
      contact_(draw, 0.01, 0.3),
      jump_(draw, 0.001, 0.05),
      leap_(draw, 0.001, 0.05),
      poseless_(draw, 0.001, 0.03),
      hold_(draw, 0.001, 0.1),
      fault_(draw, 0.001, 0.01),
      kept_(draw, 0.05, 0.6),
      silent_(draw, 0.001, 0.25),
      poor_(draw, 0.001, 0.1),
      old_(draw, 0.01, 0.3),
      strange_(draw, 0.001, 0.05) {
  slave_.X_ST.p = Vec3(0.35, 0.05, 0.43) + draw.between(0.0, 0.1) * draw.unit();
  slave_.X_ST.q = rotation_exp(draw.between(0.0, 3.0) * draw.unit());
  slave_.X_ST_command = held_ = slave_.X_ST;
  slave_.has_pose = true;
  told_.fill(slave_.X_ST);
}

void TipStandIn::step(Draw& draw, const MasterState& link, double elapsed,
                      HapticInput& in) noexcept {
  told_[tick_ % kLatest] = link.X_SU;
  answer(draw, link, elapsed);
  follow(draw, link, elapsed);
  disturb(draw, elapsed);
  ++tick_;
  hear(draw, elapsed, in);
}

void TipStandIn::answer(Draw& draw, const MasterState& link, double elapsed) noexcept {
  const bool faulted = fault_.step(draw, elapsed) && fault_.began();
  if (faulted) {
    slave_.state = SessionState::kFault;
    slave_.fault = Reason::kPeerFault;
    ++slave_.fault_epoch;
  }
  if (slave_.state == SessionState::kFault && link.fault_reset != slave_.fault_epoch) return;
  slave_.fault = Reason::kNone;
  slave_.scene = link.scene;
  slave_.hashes = link.hashes;
  slave_.position_tool_epoch = link.position_tool.epoch;
  slave_.orientation_tool_epoch = link.orientation_tool.epoch;
  slave_.engagement_epoch = link.engagement_epoch;
  const bool leads = link.desired != Desired::kOff && link.state != SessionState::kOff &&
                     link.state != SessionState::kFault;
  if (!leads || slave_.state == SessionState::kFault) {
    slave_.state = SessionState::kOff;
  } else if (link.state == SessionState::kAligning) {
    const bool there =
        link.has_command && (link.X_SU.p - slave_.X_ST_command.p).norm() < kAtCommand;
    slave_.state = there ? SessionState::kEngaged : SessionState::kAligning;
    if (there) told_.fill(link.X_SU);
  } else {
    slave_.state = hold_.step(draw, elapsed) ? SessionState::kHold : SessionState::kEngaged;
  }
}

void TipStandIn::follow(Draw& draw, const MasterState& link, double elapsed) noexcept {
  if (link.state == SessionState::kEngaged || link.state == SessionState::kClutched) {
    const Pose& told = told_[(tick_ + kLatest - late_) % kLatest];
    slave_.X_ST_command = toward(slave_.X_ST_command, told, speed_ * elapsed, turning_ * elapsed);
  }
  if (!contact_.step(draw, elapsed)) {
    held_.p += std::min(elapsed / kServoLag, 1.0) * (slave_.X_ST_command.p - held_.p);
    held_.q = slave_.X_ST_command.q;
  }
  slave_.X_ST = held_;
}

void TipStandIn::disturb(Draw& draw, double elapsed) noexcept {
  if (jump_.step(draw, elapsed)) {
    if (jump_.began()) off_ = draw.between(0.0, 0.1) * draw.unit();
    slave_.X_ST.p += off_;
  }
  if (leap_.step(draw, elapsed) && leap_.began()) {
    slave_.X_ST_command.p += draw.between(0.0, 0.1) * draw.unit();
  }
  slave_.has_pose = true;
  if (poseless_.step(draw, elapsed)) {
    if (draw.chance(0.5)) {
      slave_.has_pose = false;
    } else {
      slave_.X_ST.p.x() = std::numeric_limits<double>::quiet_NaN();
    }
  }
  constexpr auto kLimits = static_cast<Eigen::Index>(FollowStage::kLimits);
  slave_.ledger.why.fill(Reason::kNone);
  slave_.ledger.off_S.setZero();
  if (kept_.step(draw, elapsed)) {
    slave_.ledger.why[static_cast<std::size_t>(kLimits)] = Reason::kOutOfReach;
    slave_.ledger.off_S.col(kLimits) = Eigen::Vector3f(0.2f, 0.0f, 0.0f);
  }
}

void TipStandIn::hear(Draw& draw, double elapsed, HapticInput& in) noexcept {
  age_ += elapsed;
  if (!silent_.step(draw, elapsed)) {
    age_ = draw.between(0.0, 4e-3);
    in.slave = slave_;
  }
  in.slave_known = true;
  in.slave_age = static_cast<Nanos>(age_ * 1e9);
  const bool poor = poor_.step(draw, elapsed);
  in.link.received_of_100 = poor ? draw.below(101) : 100;
  in.link.peer_received_of_100 = poor ? draw.below(101) : 100;
  in.link.loop_age =
      old_.step(draw, elapsed) ? static_cast<Nanos>(draw.between(0.05, 0.4) * 1e9) : kMillisecond;
  in.link.confirmed = !strange_.step(draw, elapsed);
}

}  // namespace handrail
