// The verdict on the arm's motion by what arrived at it: whether it stops when nobody leads it, in
// time, and stays so until an operator engages.
#pragma once

#include <string>
#include <vector>

#include "devices/rig/tap.h"
#include "server/lab/faults/audit/audit_report.h"
#include "tests/faults/lateness.h"
#include "tests/faults/wire_truth.h"
#include "tests/storm/judge.h"

namespace handrail::faults {

struct Span {
  Nanos from = 0, to = 0;
};

// What was done, as far as the network does not tell.
struct Story {
  std::vector<Span> engages;         // each from the operator's order to its answer, ascending
  std::vector<Nanos> master_starts;  // ascending
  std::vector<Nanos> must_stop;      // from then on the arm must, until an operator engages
};

struct LinkVerdict {
  AuditReport report;                        // of breaches: kUnled and kLateStop
  std::vector<storm::Violation> violations;  // one a cause
  Nanos lateness = 0;                        // the worst that was granted
  std::uint64_t held = 0;                    // cycles that a moving arm got nothing in
  std::uint64_t short_gaps = 0;  // without news of over 20 ms, up to 200 ms, at the slave
  std::uint64_t trips = 0;       // gaps of over 20 ms beside the machine's own lateness
  std::uint64_t long_gaps = 0;   // about 200 ms or more, at either side: may latch
  Nanos longest_gap = 0;
};

// The bound of a stop is the fault matrix's (StopAudit) at the moment the rig got a command, and
// beside it what the machine was late by at that time, and the cycles in which the controller got
// nothing. A command may be by what was heard up to 2 ms before the rig got it, which is what a
// stop's bound grants for that way: what arrives in between is not yet in it.
// Judged from the tap's first standstill on where its beginning was overwritten.
//
// Whoever hears nothing for 20 ms leads nobody: what the master sends later than that after the
// newest of the slave's arrived is no command, and after 200 ms not until an operator engages.
LinkVerdict judge_link(const TapFile& tap, const WireTruth& truth, const Story& story,
                       const LatenessLog& lateness);

}  // namespace handrail::faults
