#include "server/follow/stuck_monitor.h"

#include <algorithm>
#include <cmath>

#include "server/base/deletable.h"

namespace handrail {
namespace {

constexpr int kStuckFor = 10;   // readings: 71 ms
constexpr int kNoisyFor = 140;  // readings: a second
constexpr int kListenFor = 70;  // readings: half a second
constexpr int kTrembling = kListenFor / 3;
// A measured tip that has not moved by it may not have moved at all: a dozen times what the
// encoders are off at the tip, and 0.4 m times a joint's play of 0.07 deg [m].
constexpr double kMoved = 5e-4;
// As much is in doubt of a payload of 3 kg whose orientation is known to 1 deg [N].
constexpr double kTurned = 0.5;
// A single wrong reading of the encoders moves nothing.
constexpr int kOverdue = 3;

// Whether `now` cannot have the load that `then` had.
bool must_differ(const BumperSettings& bumper, const WrenchReading& then,
                 const WrenchReading& now) noexcept {
  if ((now.own_T - then.own_T).norm() > kTurned) return true;
  const Vec3 f_E_S = then.X_ST.q * (then.f_E_T.force - then.own_T);
  const double force = f_E_S.norm();
  if (force <= bumper.contact) return false;
  // The surface's normal lies within the cone of friction around the force; a way beside one of
  // them goes into nothing.
  const Vec3 way = now.X_ST.p - then.X_ST.p;
  const double along = std::abs(way.dot(f_E_S)) / force;
  const double beside = std::sqrt(std::max(0.0, way.squaredNorm() - along * along));
  return along - bumper.friction * beside > kMoved * std::hypot(1.0, bumper.friction);
}

}  // namespace

bool StuckMonitor::judge(const BumperSettings& bumper, double dt,
                         const WrenchReading& now) noexcept {
  const Wrench &f = now.f_E_T, &last = first_.f_E_T;
  const bool same = known_ && f.force == last.force && f.torque == last.torque;
  if (same) {
    repeating_ = std::min(repeating_ + 1, kStuckFor);
    if (repeating_ == 1) second_ = now;
    const bool differ = must_differ(bumper, first_, now) && must_differ(bumper, second_, now);
    overdue_ = differ ? std::min(overdue_ + 1, kNoisyFor) : 0;
    changing_ = listened_ = 0;
  } else {
    listen(f, now.still);
    first_ = now;
    known_ = true;
    repeating_ = overdue_ = 0;
  }
  if (repeating_ < kStuckFor) return false;
  const int late = static_cast<int>(std::ceil(bumper.sensor_lag / dt));
  return (noisy_ && kept(Check::kStuck)) ||
         (overdue_ >= kOverdue + late && kept(Check::kUnchanged));
}

// Another reading than the last one.
void StuckMonitor::listen(const Wrench& f, bool still) noexcept {
  changing_ = std::min(changing_ + 1, kNoisyFor);
  if (!still) listened_ = 0;
  if (listened_ == 0) turns_.fill(0);
  const Wrench& last = first_.f_E_T;
  for (std::size_t i = 0; i < kAxes; ++i) {
    const auto k = static_cast<Eigen::Index>(i % 3);
    const double change = i < 3 ? f.force[k] - last.force[k] : f.torque[k] - last.torque[k];
    if (change == 0.0) continue;
    const std::int8_t rising = change > 0.0 ? 1 : -1;
    turns_[i] += rising == -rising_[i];
    rising_[i] = rising;
  }
  if (still && ++listened_ == kListenFor) {
    trembles_ |= *std::max_element(turns_.begin(), turns_.end()) >= kTrembling;
    listened_ = 0;
  }
  noisy_ |= trembles_ && changing_ >= kNoisyFor;
}

}  // namespace handrail
