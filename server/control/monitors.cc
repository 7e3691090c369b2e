#include "server/control/monitors.h"

#include <algorithm>
#include <cmath>

#include "server/base/deletable.h"

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
  if (!kept(Check::kSensor)) return Reason::kNone;
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
  const bool stuck = kept(Check::kStuck) && noisy_ && repeating_ >= kStuckFor;
  return stuck ? Reason::kSensorStuck : Reason::kNone;
}

const JointVector& JointMonitor::judge(const JointVector& q) noexcept {
  if (!kept(Check::kEncoder)) return q_ = q;
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
  images_.fill(q);
  last_ = q;
  unjudged_ = 0.0;
  outside_ = 0;
}

void FollowingMonitor::pass(const FollowingSettings& settings, const JointVector& q_command,
                            double dt) noexcept {
  for (std::size_t i = 0; i < kLags.size(); ++i) {
    // A cycle's delay: what was commanded last enters the lag now.
    images_[i] += (last_ - images_[i]) * (1.0 - std::exp(-dt / (kLags[i] * settings.slowest)));
  }
  last_ = q_command;
}

bool FollowingMonitor::lost(const FollowingSettings& settings, const JointVector& q_command,
                            const JointVector& q_measured, double dt) noexcept {
  if (!settings.checked || !kept(Check::kFollowing)) return false;
  const JointVector last = last_;
  pass(settings, q_command, dt);
  JointVector below = q_command, above = q_command;
  for (const JointVector& image : images_) {
    below = below.cwiseMin(image);
    above = above.cwiseMax(image);
  }
  const JointVector out = (below - q_measured).cwiseMax(q_measured - above);
  const double beyond = (out - (q_command - last).cwiseAbs()).maxCoeff(&joint_) - settings.room;
  if (unjudged_ >= 0.0) {
    unjudged_ = beyond > 0.0 && unjudged_ < 5.0 * settings.slowest ? unjudged_ + dt : -1.0;
    return false;
  }
  outside_ = beyond > 0.0 ? std::min(outside_ + 1, 2) : 0;
  return outside_ >= 2;
}

}  // namespace handrail
