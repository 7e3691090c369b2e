#include "devices/rig/servo_arm.h"

#include <algorithm>
#include <cmath>

#include "server/base/units.h"

namespace handrail {
namespace {

constexpr double kMinLag = 0.030;  // drawn from a longer one [s]
constexpr double kMaxLag = 0.060;  // [s]
constexpr double kStopTime =
    0.3;  // a target held this long is a stop: the slowest joint settled [s]

}  // namespace

JointVector ServoArmOptions::default_start() noexcept {
  JointVector q;
  q << 0.0, 0.0, 90.0 * kDeg, 0.0, 90.0 * kDeg, 0.0;
  return q;
}

ServoArm::ServoArm(const ServoArmOptions& options) noexcept
    : geometry_(options.geometry),
      repeatability_(options.repeatability),
      random_(options.seed),
      q_target_(options.q_start),
      q_(options.q_start) {
  for (int i = 0; i < kJoints; ++i) {
    const double drawn = options.lag * (1.0 + options.spread * (2.0 * random_.uniform() - 1.0));
    lag_[i] = std::clamp(options.joint_lag[i] > 0.0 ? options.joint_lag[i] : drawn,
                         std::min(kMinLag, options.lag), kMaxLag);
  }
  offset_target_ = draw_offset();
  offset_ = offset_target_;
}

void ServoArm::command(const JointVector& q_target) noexcept {
  if (q_target == q_target_) return;
  if (held_for_ >= kStopTime) offset_target_ = draw_offset();
  held_for_ = 0.0;
  q_target_ = q_target;
}

void ServoArm::advance(double dt) noexcept {
  held_for_ += dt;
  for (int i = 0; i < kJoints; ++i) {
    const double left = lag_[i] > 0.0 ? std::exp(-dt / lag_[i]) : 0.0;
    q_[i] = q_target_[i] + (q_[i] - q_target_[i]) * left;
    offset_[i] = offset_target_[i] + (offset_[i] - offset_target_[i]) * left;
  }
}

// Six normal joint offsets of equal spread, scaled so that at the present pose they move the tip by
// `repeatability_` RMS. Works on central differences of the tip's position.
JointVector ServoArm::draw_offset() noexcept {
  constexpr double kStep = 1e-4;  // [rad]
  double tip_per_joint = 0.0;     // sum over joints of |dp/dq|^2 [m^2]
  JointVector offset;
  for (int i = 0; i < kJoints; ++i) {
    JointVector q_low = q_;
    JointVector q_high = q_;
    q_low[i] -= kStep;
    q_high[i] += kStep;
    const Vec3 dp = forward(geometry_, q_high).p - forward(geometry_, q_low).p;
    tip_per_joint += (dp / (2.0 * kStep)).squaredNorm();
    offset[i] = random_.normal();
  }
  return tip_per_joint > 0.0 ? JointVector(offset * (repeatability_ / std::sqrt(tip_per_joint)))
                             : JointVector(JointVector::Zero());
}

}  // namespace handrail
