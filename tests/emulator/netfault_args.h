// The command line of handrail-netfault.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/base/status.h"
#include "tests/emulator/emulator.h"

namespace handrail::emulator {

// Whose end ends the run.
enum class Until { kNear, kFar, kAny, kBoth };

struct NetfaultArgs {
  EmulatorOptions options;
  std::vector<std::string> near, far;  // commands; one may be absent
  Until until = Until::kAny;
  std::string orders;                      // as OrderDesk::open() takes it
  std::string taps;                        // as Emulator::record() takes it; empty: none
  std::size_t tap_bytes = kLongestPacket;  // of each packet
  bool json = false;
  bool help = false;
};

// `words`: without the program's name. The error names the word and what was expected.
Result<NetfaultArgs> read_args(const std::vector<std::string>& words);

std::string usage();

}  // namespace handrail::emulator
