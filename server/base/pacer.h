// Wake-ups on a fixed grid of absolute times.
#pragma once

#include <cstdint>

#include "server/base/histogram.h"
#include "server/base/time.h"

namespace handrail {

// The schedule of one loop; asks no clock itself:
//
//   Pacer pacer(kMillisecond, monotonic_now());
//   for (;;) { sleep_until(pacer.due()); pacer.woke(monotonic_now()); step(); }
//
// A tick that comes late runs once; whole periods that were missed are counted and left out, never
// caught up by a burst, and the grid stays where it was. All methods are real-time safe.
class Pacer {
 public:
  // First tick at `start` + `period`. `period` > 0.
  Pacer(Nanos period, Nanos start) noexcept : period_(period), due_(start + period) {}

  // When the next tick should run, on the clock of `start`.
  Nanos due() const noexcept { return due_; }

  // The next tick is due at `time`, as another clock has it; the grid goes on from there.
  void follow(Nanos time) noexcept { due_ = time; }

  // Counts the tick that runs at `now` and moves due() to the next point of the grid after `now`.
  // Returns how many periods were missed: 0 when on time, or late by less than a period.
  std::int64_t woke(Nanos now) noexcept;

  std::uint64_t ticks() const noexcept { return ticks_; }
  // Ticks that came a whole period late or more.
  std::uint64_t overruns() const noexcept { return overruns_; }
  // The same in a row, up to the last tick; 0 when it was on time.
  std::uint64_t consecutive_overruns() const noexcept { return consecutive_; }
  // Periods left out altogether.
  std::uint64_t missed() const noexcept { return missed_; }
  // How late each tick came [ns].
  const Histogram& lateness() const noexcept { return lateness_; }

 private:
  Nanos period_;
  Nanos due_;
  std::uint64_t ticks_ = 0;
  std::uint64_t overruns_ = 0;
  std::uint64_t consecutive_ = 0;
  std::uint64_t missed_ = 0;
  Histogram lateness_;
};

// Sleeps until monotonic_now() is `time`; returns at once when that has passed. Signals do not end
// the sleep early. Daemons and drivers only.
void sleep_until(Nanos time) noexcept;

}  // namespace handrail
