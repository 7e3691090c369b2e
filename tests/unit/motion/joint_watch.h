// A watch on every joint command, for tests.
#pragma once

#include <algorithm>
#include <cmath>

#include "server/base/joints.h"

namespace handrail::test {

// Greatest share of a limit that any command has taken; 1 is the limit itself.
struct JointWatch {
  double speed = 0.0, acceleration = 0.0, jerk = 0.0;
  double range = -1e9;  // how far beyond the range [rad]; negative inside
  bool finite = true;

  bool kept() const {
    return finite && speed <= kFull && acceleration <= kFull && jerk <= kFull && range <= 0.0;
  }
  // `q`: the newest command, after those seen before.
  void see(const JointLimits& limits, double dt, const JointVector& q) {
    finite = finite && q.allFinite();
    const JointVector step = seen_ == 0 ? JointVector(JointVector::Zero()) : JointVector(q - q_);
    const JointVector change = step - step_;
    for (int i = 0; i < kJoints; ++i) {
      speed = std::max(speed, std::abs(step[i]) / (limits.max_speed[i] * dt));
      acceleration =
          std::max(acceleration, std::abs(change[i]) / (limits.max_acceleration[i] * dt * dt));
      jerk = std::max(jerk, std::abs(change[i] - change_[i]) / (limits.max_jerk[i] * dt * dt * dt));
      range = std::max({range, q[i] - limits.upper[i], limits.lower[i] - q[i]});
    }
    q_ = q;
    step_ = step;
    change_ = change;
    ++seen_;
  }

 private:
  static constexpr double kFull = 1.0 + 1e-9;
  JointVector q_ = JointVector::Zero(), step_ = JointVector::Zero(), change_ = JointVector::Zero();
  int seen_ = 0;
};

}  // namespace handrail::test
