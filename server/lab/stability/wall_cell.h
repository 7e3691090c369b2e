// A bare device at walls and effects of the master's own step, kicked.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "server/lab/stability/bench_device.h"
#include "server/lab/stability/stability_case.h"
#include "server/model/effect_list.h"

namespace handrail {

enum class WallForm : std::uint8_t {
  kWall,    // drawn, straight
  kCorner,  // drawn, two that meet in the room's corner
  kThin,    // painted, one pixel
};

enum class Governing : std::uint8_t {
  kOff,
  kEnergy,  // what is made is taken back; all is rendered as stiff as the scene says
  kOn,      // as in the master: what the device cannot hold is less stiff, too
};

inline constexpr std::array kGoverning = {std::pair{Governing::kOff, "off"},
                                          std::pair{Governing::kEnergy, "energy"},
                                          std::pair{Governing::kOn, "on"}};

enum class Lateness : std::uint8_t { kNone, kRandom, kPeriodic };

// SI. What is less than 0 is as the device has it.
struct WallCell {
  const BenchDevice* device = nullptr;
  GripKind grip = GripKind::kNone;
  WallForm form = WallForm::kWall;
  double stiffness = 800.0;  // [N/m]
  bool damped = false;       // the wall, by the device's `damping`
  double rate = 1000.0;      // of the loop [Hz]
  Lateness lateness = Lateness::kNone;
  double gap = 0.0;          // the most by which a tick is late [s]
  int delay = 0;             // until a force acts on the device, which says so [ticks]
  double resolution = -1.0;  // [m]
  // False: its driver does not say how fine its counts are; the master then counts on no loss.
  bool declared = true;
  double cutoff = -1.0;  // of the velocity's low-pass [Hz]
  double kick = 0.5;     // [m/s], within a fifth; later again by half of it, anywhere
  std::vector<EffectKind> effects = {EffectKind::kWall};
  bool at_wall = true;  // leans on it; else it is in the middle of the effects
  Governing governing = Governing::kOff;
  double most_softer = 100.0;  // chosen: softer than that, what a scene asks for is not there
};

// Runs the cell for six seconds, or longer.
//
//   over_mj      energy that a contact gave, less what the device took by itself, what ticks that
//                came late may have made (most force times speed times the time they were late)
//                and what a lock that opens lets go; with counts that are not the device's own, its
//                largest force times a count, too, which nobody sees
//   swing_mm     from side to side in two seconds, the mean over the second half of the time after
//                the first two; judged by the first half, which is 2 to 4 s and 4 to 6 s, and with
//                late ticks, which drive it anew, by the first kick's too. Where it is larger, the
//                run goes on to 24, 96 and 384 s: a swing without loss may wander, one that late
//                ticks drive comes and goes, and one that grows is larger yet
//   drift_mm     of the middle of that swing, from 2 to 4 s to the last two. Where the force is
//                lowered to what the device can sustain, what it held back gives way: such a run
//                goes on to 24 s, and the drift is that between its last two windows
//   times_softer than the scene asks for, by the master's own governing
//   seconds (that it was run), rest_mm (the middle of that swing, into the wall), given_mj,
//   contacts, change_n (largest change of the force from tick to tick) and governed_share (of the
//   ticks with a force, those in which the governor made it smaller) are told
CaseFigures run_wall_cell(const WallCell& cell, std::uint64_t seed);

}  // namespace handrail
