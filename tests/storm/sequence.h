// What is done to the programs in one sequence, drawn from a seed.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/base/time.h"

namespace handrail::storm {

enum class What : std::uint8_t {
  kPause,   // SIGSTOP, later SIGCONT
  kUnplug,  // SIGUSR2 to the rig: its controller goes on, cut off; later plugged in
  kKill,    // SIGKILL, later a new start
  kTerm,    // SIGTERM, later a new start
  kStop,    // the operator's stop
};
enum class Who : std::uint8_t { kRig, kSlave, kMaster, kComputer };  // computer: master and slave

struct Act {
  What what = What::kPause;
  Who who = Who::kSlave;
  Nanos after = 0;       // from the end of the one before, or from full speed
  Nanos lasts = 0;       // until it is undone; 0 for kStop
  bool recover = false;  // the operator finds the way out before the next one
};

struct Sequence {
  std::uint64_t seed = 1;
  double loss = 0.0;         // share of the robot's and the sensor's packets, each way
  int time_out_cycles = -1;  // of the controller; -1: none
  std::vector<Act> acts;     // 1 to 3
};

// The same for the same seed, on every machine.
Sequence draw(std::uint64_t seed);

// "rig", "slave", "master", "master and slave"
const char* name(Who who);
// "loss 2.1 %; at 0.41 s pause slave 183 ms; ..."
std::string text(const Sequence& sequence);
std::string text(const Act& act);

}  // namespace handrail::storm
