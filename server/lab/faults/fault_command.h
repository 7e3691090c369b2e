// The lab's fault matrix as a command.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "server/lab/faults/fault_rows.h"

namespace handrail {

struct FaultCommand {
  std::string row;  // one row, or all whose id begins so: N1 is N1a and N1b; empty: all
  std::uint64_t seed = 1;
  int threads = 0;  // 0: one a core; results do not depend on it
  bool json = false;
  std::string without;  // a check to leave out
  bool prove = false;   // instead: every check left out in turn
};

struct FaultResult {
  const FaultRow* row = nullptr;
  int runs = 0;
  std::uint64_t violations = 0;
  bool measured = false;
  double worst = 0.0;  // of the run that came nearest to its bound or passed it furthest
  double bound = 0.0;
  std::uint64_t shown_seed = 0;  // of the first run with a violation, else of the worst
  int shown_index = 0;
  std::string found;     // by that run
  double settled = 0.0;  // of all runs [ms]
  double harder = 0.0;   // [N]
  double deeper = 0.0;   // [mm]
};

// All runs of `rows`, on `threads` threads. Fewer when cancelled.
std::vector<FaultResult> run_faults(const std::vector<FaultRow>& rows, std::uint64_t seed,
                                    int threads, const std::atomic<bool>& cancelled);

// How many of the first `runs` of a row find violations named `what`.
int runs_that_find(const FaultRow& row, int runs, const char* what, std::uint64_t seed, int threads,
                   const std::atomic<bool>& cancelled);

std::string fault_json(const std::vector<FaultResult>& results);
std::string fault_table(const std::vector<FaultResult>& results);

// Exit codes: 0 no violations, or every check proven to be needed; 1 some, or not; 2 no such row or
// check; 130 cancelled.
int run_fault_command(const FaultCommand& command, const std::atomic<bool>& cancelled);

}  // namespace handrail
