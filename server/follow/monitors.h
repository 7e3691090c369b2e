// What says that a sensor, an encoder or the arm itself is not to be trusted.
#pragma once

#include <array>

#include "server/base/joints.h"
#include "server/base/spatial.h"
#include "server/follow/stuck_monitor.h"
#include "server/model/reason.h"

namespace handrail {

// Judges the force sensor, once a cycle of about 7 ms. Real-time safe.
class WrenchMonitor {
 public:
  // What is wrong with the newest reading: kSensorOverrange (the sensor says so, or a component is
  // over `range` [N]), kSensorMissing (not fresh), kSensorInvalid (not finite, or a jump of over
  // 100 N that has only just come), kSensorStuck (StuckMonitor), else kNone. `dt`: cycle [s].
  Reason judge(const BumperSettings& bumper, double range, double dt,
               const WrenchReading& now) noexcept;

 private:
  Vec3 last_ = Vec3::Zero();  // newest sound force [N]
  bool known_ = false;
  bool jumped_ = false;
  StuckMonitor stuck_;
};

// Judges the measured joints. Real-time safe.
class JointMonitor {
 public:
  // Cycles of the controller have passed, whether or not anything was measured.
  void pass(int cycles) noexcept;
  // The joints to believe: `q`, or the last sound ones where `q` is not finite or has moved by over
  // 0.1 rad for each cycle since then. The third in a row is `broken`, at `joint`; then a finite
  // `q` is a new start.
  const JointVector& judge(const JointVector& q) noexcept;
  // What was judged last.
  const JointVector& newest() const noexcept { return q_; }
  bool broken() const noexcept { return bad_ >= 3; }
  int joint() const noexcept { return joint_; }

 private:
  JointVector q_ = JointVector::Zero();
  bool known_ = false;
  int cycles_ = 0;  // since the last sound ones
  int bad_ = 0;
  int joint_ = -1;
};

// How an arm may follow its commands.
struct FollowingSettings {
  bool checked = true;
  double slowest = 0.100;  // time constant of the slowest sound arm, after a cycle's delay [s]
  double room = 0.01;      // beside it, and as far as the command moves in a cycle [rad]
};

// Judges whether the arm follows: the measured joints lie among the command and its images behind
// lags of up to `slowest`. An arm taken over in motion has five times that to come to where it is
// commanded before it is judged. Real-time safe.
class FollowingMonitor {
 public:
  void restart(const JointVector& q) noexcept;
  // One cycle of `dt` [s]: what was measured after `q_command` was the newest. True from the second
  // cycle in a row outside, with the joint furthest out in joint().
  bool lost(const FollowingSettings& settings, const JointVector& q_command,
            const JointVector& q_measured, double dt) noexcept;
  // One cycle in which nothing was measured.
  void pass(const FollowingSettings& settings, const JointVector& q_command, double dt) noexcept;
  int joint() const noexcept { return joint_; }

 private:
  // Of `slowest`. Where a joint turns, images of lags between two others lie beside both: by a
  // milliradian at most, as close as these are.
  static constexpr std::array<double, 7> kLags = {0.04, 0.1, 0.2, 0.35, 0.55, 0.75, 1.0};

  std::array<JointVector, kLags.size()> images_{};
  std::array<double, kLags.size()> shares_{};  // of the way to what was commanded, in `cycles_`
  double cycles_ = 0.0;                        // of dt, in settings.slowest
  JointVector last_ = JointVector::Zero();
  double unjudged_ =
      0.0;  // since the restart, while the arm is on its way [s]; negative: it has come
  int outside_ = 0;
  int joint_ = -1;
};

}  // namespace handrail
