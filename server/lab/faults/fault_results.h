// What the runs of the fault matrix have come to, and how it is printed.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/lab/faults/fault_rows.h"

namespace handrail {

// Of one row, over all seeds.
struct FaultResult {
  const FaultRow* row = nullptr;
  int runs = 0;
  std::uint64_t violations = 0;
  bool measured = false;
  double worst = 0.0;  // of the run that came nearest to its bound or passed it furthest
  double bound = 0.0;
  std::uint64_t shown_seed = 0;  // of the first run with a violation, else of the worst
  int shown_index = 0;
  std::string found;                     // by that run
  std::vector<std::uint64_t> red_seeds;  // with violations, each once
  double settled = 0.0;                  // of all runs [ms]
  double harder = 0.0;                   // [N]
  double deeper = 0.0;                   // [mm]
};

// Counts run `index` of `seed`. All runs of a seed come one after the other.
void add_run(FaultResult& result, const FaultOutcome& run, std::uint64_t seed, int index);

std::uint64_t violations_of(const std::vector<FaultResult>& results);
std::string fault_json(const std::vector<FaultResult>& results);
std::string fault_table(const std::vector<FaultResult>& results);

}  // namespace handrail
