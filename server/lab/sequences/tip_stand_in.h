// Stands in for the arm and the link to it: a tip that follows the command, and all that goes
// wrong.
#pragma once

#include <array>

#include "server/haptic/haptic_step.h"
#include "server/lab/sequences/draw.h"

namespace handrail {

class TipStandIn {
 public:
  explicit TipStandIn(Draw& draw) noexcept;

  // `elapsed` [s] after the master said `link`: what it next hears of the slave and the link.
  void step(Draw& draw, const MasterState& link, double elapsed, HapticInput& in) noexcept;

 private:
  void answer(Draw& draw, const MasterState& link, double elapsed) noexcept;
  void follow(Draw& draw, const MasterState& link, double elapsed) noexcept;
  void disturb(Draw& draw, double elapsed) noexcept;
  void hear(Draw& draw, double elapsed, HapticInput& in) noexcept;

  static constexpr std::size_t kLatest = 64;  // [ticks]

  SlaveState slave_;                // as it is
  std::array<Pose, kLatest> told_;  // commands, on their way
  std::size_t tick_ = 0;
  std::size_t late_;        // commands come so many ticks later
  double speed_, turning_;  // of the tip, at most [m/s], [rad/s]
  double age_ = 0.0;        // of what the master knows of the slave [s]
  bool takes_part_ = false;
  // In turn: the tip is held as in contact; it stands elsewhere; it and its command do; no pose is
  // known; the slave holds; it faults; a limit keeps it back; nothing comes; little comes; the loop
  // is old; this session is not confirmed.
  Spell contact_, jump_, leap_, poseless_, hold_, fault_, kept_, silent_, poor_, old_, strange_;
  Vec3 off_ = Vec3::Zero();  // while it stands elsewhere [m]
  Pose held_;
};

}  // namespace handrail
