// The command line of handrail-faults.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/base/status.h"
#include "tests/faults/row.h"

namespace handrail::faults {

struct FaultsArgs {
  std::vector<const FaultRow*> rows;  // those named, else all
  bool full = false, json = false, list = false, help = false, resume = false;
  bool seeded = false;
  std::uint64_t seed = 0;  // drawn when not seeded
  std::string results = "build/faults";
};

// `words`: without the program's name. The error names the word and what was expected.
Result<FaultsArgs> read_faults_args(const std::vector<std::string>& words);

std::string faults_usage();

}  // namespace handrail::faults
