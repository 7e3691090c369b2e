// A slave's step over a floor that its sensor feels, for tests.
#pragma once

#include <algorithm>
#include <deque>
#include <random>

#include "tests/unit/follow/follow_rig.h"

namespace handrail::test {

// An engaged arm 2 mm over a floor, the measured joints `late` cycles behind.
struct Floor {
  FollowRig rig;
  Pose X;                                 // commanded
  double stiffness;                       // [N/m]
  double sign = 1.0;                      // of the sensor
  double surface = 0.0;                   // height [m]
  double force = 0.0;                     // the true one [N]
  double noise = 0.0;                     // of the sensor, each axis, RMS [N]
  JointVector off = JointVector::Zero();  // what the encoders are off by [rad]
  bool silent = false;                    // nothing is told: what was measured last stands
  JointVector told;                       // measured [rad]
  std::mt19937_64 random{11};
  std::deque<JointVector> q;

  explicit Floor(double k, int late = 0) : stiffness(k) {
    rig.engage();
    surface = rig.tip.p.z() - 2e-3;
    X = rig.state.motion.X_ST;
    told = rig.joints();
    q.assign(static_cast<std::size_t>(late) + 1, told);
  }
  double height() const { return forward(rig.settings.motion->arm, q.front()).p.z(); }
  Vec3 rest() const {
    const StopPlan& stop = rig.state.motion.stop;
    if (stop.done()) return rig.state.motion.X_ST.p;
    const auto last = static_cast<std::size_t>(stop.size - 1);
    return forward(rig.settings.motion->arm, stop.q[last]).p;
  }
  double wobble() {
    return noise == 0.0 ? 0.0 : noise * std::normal_distribution<double>()(random);
  }
  // One cycle; the tip frame's +Z is the base's -Z.
  void cycle() {
    if (!silent) told = q.front() + off;
    rig.in.q_measured = told;
    force = stiffness * std::max(0.0, surface - height());
    rig.in.f_E_T.force = {wobble(), wobble(), wobble() - sign * force};
    rig.follow(X);
    q.push_back(rig.joints());
    q.pop_front();
  }
  void down(double speed, double depth) {
    X.p.z() = std::max(surface - depth, X.p.z() - speed * rig.settings.motion->dt);
    cycle();
  }
};

}  // namespace handrail::test
