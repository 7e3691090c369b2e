#include "server/follow/monitors.h"

#include <algorithm>
#include <cmath>

#include "server/base/deletable.h"

namespace handrail {
namespace {

constexpr double kSpike = 100.0;  // [N]
constexpr double kJump = 0.1;     // [rad] a cycle
constexpr int kBadJoints = 3;
constexpr int kLong = 1000;  // [cycles]: at kJump each further than any joint's range

}  // namespace

Reason WrenchMonitor::judge(const BumperSettings& bumper, double range, double dt,
                            const WrenchReading& now) noexcept {
  if (!kept(Check::kSensor)) return Reason::kNone;
  if (now.overrange) return Reason::kSensorOverrange;
  if (!now.fresh) return Reason::kSensorMissing;
  if (!is_finite(now.f_E_T)) return Reason::kSensorInvalid;
  const Vec3& f = now.f_E_T.force;
  if (f.cwiseAbs().maxCoeff() > range) return Reason::kSensorOverrange;
  // A spike comes and goes; what stays is a force.
  if (known_ && !jumped_ && (f - last_).norm() > kSpike) {
    jumped_ = true;
    return Reason::kSensorInvalid;
  }
  jumped_ = false;
  last_ = f;
  known_ = true;
  return stuck_.judge(bumper, dt, now) ? Reason::kSensorStuck : Reason::kNone;
}

void JointMonitor::pass(int cycles) noexcept { cycles_ = std::min(cycles_ + cycles, kLong); }

const JointVector& JointMonitor::judge(const JointVector& q) noexcept {
  if (!kept(Check::kEncoder)) return q_ = q;
  const bool finite = q.allFinite();
  Eigen::Index worst = 0;
  if (!finite) {
    while (worst + 1 < kJoints && std::isfinite(q[worst])) ++worst;
  } else if (!known_ || (q - q_).cwiseAbs().maxCoeff(&worst) <= kJump * cycles_) {
    bad_ = cycles_ = 0;
    known_ = true;
    return q_ = q;
  }
  if (bad_ >= kBadJoints && finite) {
    bad_ = cycles_ = 0;
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
  if (const double cycles = dt / settings.slowest; cycles != cycles_) {
    cycles_ = cycles;
    for (std::size_t i = 0; i < kLags.size(); ++i) shares_[i] = 1.0 - std::exp(-cycles / kLags[i]);
  }
  for (std::size_t i = 0; i < kLags.size(); ++i) {
    // A cycle's delay: what was commanded last enters the lag now.
    images_[i] += (last_ - images_[i]) * shares_[i];
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
