// A driver who knows the gate: where the hand wants to be, tick by tick.
#pragma once

#include <vector>

#include "server/lab/walls/gearshift_run.h"

namespace handrail {

// Moves between gears along the middle of the aisles, in one minimum-jerk movement each, waits to
// feel the lock, rests a little and goes on. Out of the last gear the hand goes along with the
// lever until it rests.
class GearDriver {
 public:
  // `pace` times the usual speed.
  GearDriver(const GearGate& gate, double pace);

  // What the hand follows after `tick`.
  void drive(const WallTick& tick);
  const Vec2& p() const noexcept { return p_; }  // [m]
  const Vec2& v() const noexcept { return v_; }  // [m/s]
  bool done() const noexcept { return phase_ == Phase::kDone; }

 private:
  enum class Phase { kMove, kFeel, kLetGo, kDone };

  void set_out(double t);
  void go(double t, const WallTick& tick);

  const GearGate& gate_;
  double pace_;
  std::size_t next_ = 0;  // gear; past the last: home
  Phase phase_ = Phase::kMove;
  std::vector<Vec2> way_;
  double length_ = 0.0, duration_ = 1.0;  // of the way
  double since_ = 0.0;                    // start of the phase [s]
  double locked_since_ = 0.0;             // [s]
  RestWatch rest_;
  Vec2 p_, v_ = Vec2::Zero();
};

}  // namespace handrail
