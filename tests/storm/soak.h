// Hours of faults in a row, with nothing started anew: does any program grow?
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>

#include "tests/storm/results.h"
#include "tests/storm/run.h"
#include "tests/storm/slope.h"

namespace handrail::storm {

constexpr double kMostGrowth = 1.0;  // [MiB/h]

struct Growth {
  double first = 0.0, last = 0.0, largest = 0.0;  // resident [MiB]
  Slope slope;                                    // [MiB/h]
};

struct SoakOutcome {
  bool complete = false;  // false: interrupted
  double minutes = 0.0;   // that count, after the warm-up
  std::uint64_t clients = 0;
  std::array<Growth, 3> growth;  // by Who
  std::vector<std::string>
      violations;  // of the arm's limits, of a stop, of the way out; empty: none
};

// Rig, slave and master at full rate for `minutes`, while one of them is paused, the rig cut off or
// the arm stopped every few seconds, packets are lost, and clients come that ask, garble or fall
// silent; the operator finds the way out each time and drives on. The taps of the last eight
// minutes are judged. `say`: a line of progress every half minute. `violated`: called before the
// taps of a run with violations go.
SoakOutcome run_soak(
    std::uint64_t seed, double minutes, bool (*interrupted)(),
    const std::function<void(const std::string&)>& say,
    const std::function<void(const Sequence&, const Outcome&, const Run&)>& violated);

// A table for people, with the verdict.
std::string for_people(const SoakOutcome& outcome);
bool grows(const SoakOutcome& outcome);

}  // namespace handrail::storm
