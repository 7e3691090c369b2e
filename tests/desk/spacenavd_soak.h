// Debian's spacenavd and our driver, for as long as one likes, with each frame counted.
#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "server/base/status.h"
#include "server/base/time.h"

namespace handrail::desk {

struct SoakPlan {
  double seconds = 600.0;
  double rate = 1000.0;  // frames that the Magellan sends, 1 to 4000 [Hz]
};

// Frames, each of them another.
struct SoakFigures {
  std::uint64_t pushed = 0;   // into the pseudo-terminal
  std::uint64_t waited = 0;   // for room in it, at most one a turn
  std::uint64_t told = 0;     // by spacenavd, to a client that only counts
  std::uint64_t heard = 0;    // by the driver
  std::uint64_t astray = 0;   // of `told`: none that was pushed, or not later than the one before
  std::uint64_t invalid = 0;  // readings of the driver
  double seconds = 0.0;
  double late_ms = 0.0;  // of the worst second: 99.9 % of the driver's readings came no later
};

// Nothing was lost but what spacenavd kept to itself.
bool whole(const SoakFigures& figures);

// The number that a frame bears, and back; -1: no frame of ours. Pure.
std::array<int, 6> frame_of(std::uint64_t number);
std::int64_t number_in(const std::array<std::int32_t, 6>& counts);

// Pushes until the time is over or `stopped` says so. The error says what could not be had.
Result<SoakFigures> soak(const SoakPlan& plan, const std::function<bool()>& stopped);

}  // namespace handrail::desk
