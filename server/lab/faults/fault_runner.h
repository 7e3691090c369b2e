// Runs rows of the fault matrix at seeds, on several threads.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "server/lab/faults/fault_journal.h"
#include "server/lab/faults/fault_results.h"

namespace handrail {

struct FaultRuns {
  std::span<const FaultRow> rows;
  std::vector<std::uint64_t> seeds = {1};
  bool quick = false;   // fewer runs, with long spans cut to kQuickShare
  int threads = 0;      // 0: one a core; results do not depend on it
  bool replay = false;  // each is recorded and done again
};

// Where the runs stand. Called before the first, and then by one thread at a time.
struct FaultProgress {
  std::size_t runs = 0;
  std::size_t of = 0;
  std::uint64_t violations = 0;
  // The seed that this run has completed, with its violations; null while one is under way.
  const std::uint64_t* seed_done = nullptr;
  std::uint64_t of_seed = 0;
};

// A result for each row. What `journal`, if any, knows is not run again, and it is told the rest.
// Ends early, with the runs so far, when cancelled; with an error when the journal cannot be
// written.
Result<std::vector<FaultResult>> run_faults(
    const FaultRuns& what, const std::atomic<bool>& cancelled, FaultJournal* journal = nullptr,
    const std::function<void(const FaultProgress&)>& progress = {});

// How many of the first `runs` of a row find violations named `what`.
int runs_that_find(const FaultRow& row, int runs, const char* what, std::uint64_t seed, int threads,
                   const std::atomic<bool>& cancelled);

}  // namespace handrail
