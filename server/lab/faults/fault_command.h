// The lab's fault matrix as a command.
#pragma once

#include <atomic>
#include <string>

namespace handrail {

struct FaultCommand {
  std::string row;          // one row, or all whose id begins so: N1 is N1a and N1b; empty: all
  std::string seeds = "1";  // such as 7 or 1..50
  bool quick = false;       // every row, in about a minute
  bool replay = false;      // every run is recorded and done again: what differs is a violation
  std::string results;      // file of finished runs, to go on from; empty: none
  std::string out;          // file for the table; empty: none
  int threads = 0;          // 0: one a core; results do not depend on it
  bool json = false;
  std::string without;  // a check to leave out
  bool prove = false;   // instead: every check left out in turn
};

// Exit codes: 0 no violations, or every check proven to be needed; 1 some, or not; 2 no such row,
// check or seed, or a file that cannot be used; 130 cancelled.
int run_fault_command(const FaultCommand& command, const std::atomic<bool>& cancelled);

}  // namespace handrail
