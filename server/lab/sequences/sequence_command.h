// handrail-lab tool-sequences: the bounds of the master's step, at random and in named cases.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

namespace handrail {

struct SequenceCommand {
  std::uint64_t sequences = 1000;
  std::uint64_t seed = 1;  // of the first; the others follow
  std::string results;     // file that says how far it has come; empty: none
  bool resume = false;     // go on from it
  bool cases = false;      // the named cases instead
  int threads = 0;         // 0: one a core; results do not depend on it
  bool json = false;
};

// A LabExit; kFailed where a bound is broken.
int run_sequence_command(const SequenceCommand& command, const std::atomic<bool>& cancelled);

}  // namespace handrail
