// A driver who knows the gate: where the hand wants to be, tick by tick.
#pragma once

#include <vector>

#include "server/lab/walls/gearshift_run.h"

namespace handrail {

// Moves between gears along the middle of the aisles, in one minimum-jerk movement each, waits to
// feel the lock, rests a little and goes on. A gear whose lock does not close is left and entered
// again, a few times. Out of the last gear the hand lets go, and the lever is watched until it
// rests.
class GearDriver {
 public:
  static constexpr int kTries = 4;

  // `pace` times the usual speed.
  GearDriver(const GearGate& gate, double pace);

  // What the hand does after `tick`.
  void drive(const WallTick& tick);
  const Vec2& p() const noexcept { return p_; }  // where it wants to be [m]
  const Vec2& v() const noexcept { return v_; }  // [m/s]
  bool lets_go() const noexcept { return phase_ == Phase::kLetGo || phase_ == Phase::kDone; }
  bool done() const noexcept { return phase_ == Phase::kDone; }

 private:
  // kBack is out of a gear that did not lock.
  enum class Phase { kMove, kBack, kFeel, kLetGo, kDone };

  bool home() const noexcept { return next_ == gate_.places().size(); }
  Vec2 foot() const;  // of the next gear's aisle
  void set_out(Phase phase, const Vec2& from, const Vec2& to, double t);
  void set_out_for_next(double t);
  void go(const WallTick& tick);
  void feel(const WallTick& tick);

  const GearGate& gate_;
  double pace_;
  std::size_t next_ = 0;  // gear; past the last: home
  int tries_ = 0;         // of this gear that failed
  Phase phase_ = Phase::kMove;
  std::vector<Vec2> way_;
  double length_ = 0.0, duration_ = 1.0;  // of the way
  double since_ = 0.0;                    // start of the phase [s]
  double locked_since_ = 0.0;             // [s]
  RestWatch rest_;
  Vec2 p_, v_ = Vec2::Zero();
};

}  // namespace handrail
