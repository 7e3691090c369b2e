// handrail-lab stability: whether what is rendered at the hand is stable.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

namespace handrail {

struct StabilityCommand {
  bool quick = false;      // one seed of what is drawn
  std::string only = {};   // a case, or the first parts of its name; empty: all
  std::uint64_t seed = 1;  // the first
  int seeds = 0;           // of each case that is drawn; 0: as many as the suite has
  bool list = false;
  int threads = 0;  // 0: one a core; results do not depend on it
  bool json = false;
  std::string figures = {};  // folder; empty: none
};

// A LabExit; kFailed where a case that must hold does not.
int run_stability_command(const StabilityCommand& command, const std::atomic<bool>& cancelled);

}  // namespace handrail
