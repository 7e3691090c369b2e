// One random sequence of hand, orders, link and arm through the master's step, and its bounds.
#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "server/lab/sequences/bounds.h"

namespace handrail {

// The tick that came nearest to a bound, or broke it furthest.
struct Worst {
  Judged judged;
  std::uint64_t seed = 0;
  int tick = 0;
};

// Of one sequence or many.
struct SequenceFigures {
  std::array<Worst, kBounds> worst{};
  std::array<std::uint64_t, kBounds> broken{};  // ticks
  std::uint64_t sequences = 0;
  std::uint64_t ticks = 0;
  std::uint64_t led = 0;      // of them, the session led the arm
  std::uint64_t tools = 0;    // tools called, of those that were not refused
  std::uint64_t refused = 0;  // orders

  bool holds() const noexcept;
  // Adds what came later. Of two that are equally bad the earlier stays.
  void add(const SequenceFigures& later) noexcept;
};

inline constexpr int kSequenceTicks = 1000;

// What a sequence may see beside figures, after each tick.
struct SequenceTick {
  int tick;
  double dt;
  const HapticSettings& settings;
  const HapticInput& in;
  const HapticOutput& out;
  const Watch& watch;
};

// For those who look closer, and for tests of the bounds.
struct SequenceOptions {
  // Changes the step's settings behind the back of the bounds.
  std::function<void(HapticSettings&)> tamper = {};
  std::function<void(const SequenceTick&)> look = {};
};

// kSequenceTicks ticks drawn by `seed` alone. The scene is the default one with scale 1 or 2, a
// damper or none, tools called up to 20 or 60 mm away, the smoother of 200 or 105 samples, on an
// Omni with torque or without, governor on or off. A late tick is 1 to 20 ms late, and is given to
// the step as the haptic loop does: at most 5 ms of it.
SequenceFigures run_sequence(std::uint64_t seed, const SequenceOptions& options = {});

}  // namespace handrail
