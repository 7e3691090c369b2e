// A day of it, and counters that only years would bring to their ends.
#pragma once

#include "server/lab/stability/stability_case.h"
#include "server/lab/stability/whole_loop.h"

namespace handrail {

// A hand that goes to drawn places, touches a surface if there is one, and comes home, over a link
// of 20 +- 2 ms that loses 1 %; in parts, at each one's end at rest where it began.
//
//   drift_um    of the tip from where the hand asks it to be, from part to part, most
//   growth      of what is counted (holds, silences, halts, targets the guard did not pass, refused
//               and unsent datagrams) from the first half to the second: beyond what chance
//               explains
//   later_ms    the oldest loop and command of the second half, beyond those of the first
//   bounds, ended   as of teleoperation; path_m of the tip and what is counted are told
struct LongRun {
  int parts = 24;
  double part = 3600.0;  // at least 10 [s]
  bool surface = false;  // there is one to touch
  // Raised: the run ends soon, and what it came to says nothing. None: it runs to its end.
  const std::atomic<bool>* cancelled = nullptr;
};
CaseOutcome run_long(const LongRun& run, std::uint64_t seed);

// A hand that turns about the centre of a progressive friction, once a second, for so long [s]:
// `off_urad`, of the angle that was summed from the one turned, at most a nanoradian. `cancelled`
// as of LongRun.
CaseOutcome run_turns(double seconds, const std::atomic<bool>* cancelled = nullptr);

// Engaging, moving and stopping five times from these counters on, beside the same from none:
// `apart_um`, of the tips, at any time: none; `engagements_missing`.
CaseOutcome run_counters(const LoopCounters& counters);
// The datagrams' numbers end within the run: the engagement ends, and the arm stands:
// `tip_moved_um` in the second after, `still_engaged`.
CaseOutcome run_last_datagram();

}  // namespace handrail
