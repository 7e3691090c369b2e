// The lab's commands for the linear movement: the study and the fit.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

namespace handrail {

struct LinearCommand {
  std::string scene = "linear-movement";
  std::string population = "linear-movement";
  int operators = 7;
  int trials = 2;
  std::uint32_t seed = 1;
  int threads = 0;  // 0: one a core
  bool json = false;
  std::string figures;                // folder for the SVG files; empty: none
  std::vector<std::string> settings;  // KEY=VALUE, all together one variation
  std::vector<std::string> sweeps;    // KEY=VALUE,VALUE,..., a variation for each value
};

struct FitCommand {
  std::string scene = "linear-movement";
  std::string population = "linear-movement";
  int operators = 40;
  std::uint32_t seed = 1001;
  int threads = 0;
  std::string out;     // file to write; empty: the population's own
  bool check = false;  // write nothing; say whether the file is what the fit gives
};

// Exit codes: 0 done, 1 the run could not be made (or `check` found a difference), 2 bad file or
// setting, 130 cancelled. Results go to the standard output, progress and errors to the error
// output. `cancelled` is raised from outside, as by Ctrl-C.
int run_linear_command(const LinearCommand& command, const std::atomic<bool>& cancelled);
int run_fit_command(const FitCommand& command, const std::atomic<bool>& cancelled);

}  // namespace handrail
