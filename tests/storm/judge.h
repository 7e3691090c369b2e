// The verdict on one sequence, from the rig's taps and what the operator was told.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "devices/rig/tap.h"
#include "server/base/time.h"

namespace handrail::storm {

// A span in which nothing may move, on the machine's monotonic clock.
struct Forbidden {
  Nanos from = 0, to = 0;
  std::string why;
};

// What the taps show.
struct Figures {
  std::uint64_t targets = 0;                          // accepted
  std::uint64_t breaches = 0;                         // of them beyond a limit
  double step = 0.0, acceleration = 0.0, jerk = 0.0;  // largest, of the limit
  std::uint64_t held = 0;     // cycles in which a moving arm was held for want of a target
  std::uint64_t late = 0;     // more such cycles: their command came after them
  std::uint64_t halts = 0;    // motions that ended without braking
  double hardest_halt = 0.0;  // of the acceleration limit

  void add(const Figures& other);
};

struct Violation {
  Nanos at = 0;
  std::string what;
};

// The first record that can be judged. Of a ring whose beginning was overwritten nobody knows what
// moved before: it is the first standstill.
std::size_t first_judged(const TapFile& tap);

// Judges one tap: every accepted target by the joint limits, and every motion by what was
// forbidden. One violation a cause: what follows within 0.2 s belongs to it. A tap that has written
// over its beginning is judged from the first standstill on.
Figures judge_tap(const TapFile& tap, const std::vector<Forbidden>& forbidden,
                  std::vector<Violation>& violations);

// The tap around `at` for people, a line a cycle, J1 to J6 in degrees.
std::string trace(const TapFile& tap, Nanos at, int before, int after);

// Where the arm was at `at`, by its encoders; nothing when the tap does not cover it.
bool measured_at(const TapFile& tap, Nanos at, JointVector& q);

}  // namespace handrail::storm
