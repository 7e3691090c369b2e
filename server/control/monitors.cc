#include "server/control/monitors.h"

#include <algorithm>
#include <cmath>

namespace handrail {
namespace {

constexpr double kSpike = 100.0;  // [N]
constexpr int kNoisyFor = 140;    // cycles: a second
constexpr int kStuckFor = 10;     // cycles: 71 ms
constexpr double kJump = 0.1;     // [rad] a cycle
constexpr int kBadJoints = 3;

bool equal(const Wrench& a, const Wrench& b) { return a.force == b.force && a.torque == b.torque; }

}  // namespace

Reason WrenchMonitor::judge(const Wrench& f, bool fresh, double range) noexcept {
  if (!fresh) return Reason::kSensorMissing;
  if (!is_finite(f) || f.force.cwiseAbs().maxCoeff() > range) return Reason::kSensorInvalid;
  const bool same = known_ && equal(f, last_);
  const bool jump = known_ && (f.force - last_.force).norm() > kSpike;
  // A spike comes and goes; what stays is a force.
  if (jump && !jumped_) {
    jumped_ = true;
    return Reason::kSensorInvalid;
  }
  jumped_ = false;
  last_ = f;
  known_ = true;
  repeating_ = same ? std::min(repeating_ + 1, kStuckFor) : 0;
  changing_ = same ? 0 : std::min(changing_ + 1, kNoisyFor);
  if (changing_ >= kNoisyFor) noisy_ = true;
  return noisy_ && repeating_ >= kStuckFor ? Reason::kSensorStuck : Reason::kNone;
}

const JointVector& JointMonitor::judge(const JointVector& q) noexcept {
  const bool finite = q.allFinite();
  Eigen::Index worst = 0;
  if (!finite) {
    while (worst + 1 < kJoints && std::isfinite(q[worst])) ++worst;
  } else if (!known_ || (q - q_).cwiseAbs().maxCoeff(&worst) <= kJump * (bad_ + 1)) {
    bad_ = 0;
    known_ = true;
    return q_ = q;
  }
  if (bad_ >= kBadJoints && finite) {
    bad_ = 0;
    return q_ = q;
  }
  joint_ = static_cast<int>(worst);
  bad_ = std::min(bad_ + 1, kBadJoints);
  return q_;
}

void FollowingMonitor::restart(const JointVector& q) noexcept {
  slow_ = last_ = q;
  outside_ = 0;
}

bool FollowingMonitor::lost(const FollowingSettings& settings, const JointVector& q_command,
                            const JointVector& q_measured, double dt) noexcept {
  if (!settings.checked) return false;
  const JointVector below = slow_.cwiseMin(q_command), above = slow_.cwiseMax(q_command);
  const double beyond =
      (below - q_measured).cwiseMax(q_measured - above).maxCoeff(&joint_) - settings.room;
  // A cycle's delay: what was commanded last enters the lag now.
  slow_ += (last_ - slow_) * (1.0 - std::exp(-dt / settings.slowest));
  last_ = q_command;
  outside_ = beyond > 0.0 ? std::min(outside_ + 1, 2) : 0;
  return outside_ >= 2;
}

}  // namespace handrail
