// handrail demo while the machine takes one of its programs away now and then.
#pragma once

#include <cstdint>
#include <string>

namespace handrail::storm {

struct DemoOutcome {
  bool complete = false;  // false: interrupted
  int pauses = 0;
  std::string problem;  // empty: it ended with its table
};

// Rig, slave and master as they are shipped, and the demo, whose programs are paused once in every
// 20 s, one at random, for 20 to 500 ms. Takes about a minute of real time.
DemoOutcome run_demo(std::uint64_t seed, bool (*interrupted)());

}  // namespace handrail::storm
