// Who gets the device's force: tool first, spring what is left, limits last.
#pragma once

#include "server/base/spatial.h"

namespace handrail {

struct ForceLimits {
  double peak = 3.3;           // largest force the device makes [N]
  double continuous = 0.88;    // force it sustains [N]
  double thermal_time = 10.0;  // averaging time of the motors' heat (engineering choice) [s]
  // Largest step of the force a millisecond, beside what the hand's own motion explains [N].
  double step = 0.05;
  // Time in which any force leaves when it is no longer trusted: after the 20 ms in which the link
  // counts as alive, it is gone within 50 ms of the last datagram [s].
  double fade_out = 0.025;
};

// Where the device's force came from this tick, frame M [N]. The three add up to `device`. Tool and
// spring are what the peak leaves them; `limited` is what the step and fade limits added or took.
struct ForceShares {
  Vec3 tool = Vec3::Zero();
  Vec3 spring = Vec3::Zero();
  Vec3 limited = Vec3::Zero();
  Vec3 device = Vec3::Zero();
  Vec3 peak_took = Vec3::Zero();  // what the peak, or heat lowering it, took from the tool
  bool budget = false;            // the spring was reduced in favour of the tool
  bool clamped = false;           // the tool alone exceeds the peak, or the spring without a tool
  bool thermal = false;           // the continuous limit lowers the peak
  bool stepped = false;           // the step limit acted
};

// Which of the wanted forces are given. Where it is not both, the force follows what is given as
// fast as it leaves within `fade_out`.
enum class Trust {
  kBoth,
  kTool,  // the spring counts as none
  kNone,
};

// Keeps the heat estimate and the previous force. Real-time safe.
class Arbiter {
 public:
  // Cuts the force at once (the heat stays): the device has stopped saying where the hand is.
  void cut() noexcept { last_.setZero(); }

  // `f_tool`, `f_spring`: wanted forces on the hand, frame M [N]. `hand_allowance`: stiffness times
  // the hand's motion since the last tick, and damping times its change of velocity [N]; without
  // trust in anything it counts as none. `dt` [s]. Non-finite input counts as no force.
  ForceShares share(const ForceLimits& limits, Vec3 f_tool, Vec3 f_spring, double hand_allowance,
                    Trust trust, double dt) noexcept;

 private:
  Vec3 last_ = Vec3::Zero();
  double heat_ = 0.0;  // mean square force over thermal_time [N^2]
};

}  // namespace handrail
