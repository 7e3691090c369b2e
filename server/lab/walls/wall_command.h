// The lab's commands for wrench and gearshift.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

namespace handrail {

struct WallCommand {
  std::string scene;
  std::string walls = "exact";    // or "subpixel", "published": as drawn, or painted first
  double pixel = 0.1;             // of a painted map [mm]
  bool published_damper = false;  // that of (2.1) to the letter
  int operators = 1;
  std::uint32_t seed = 1;
  int threads = 0;  // 0: one a core
  bool json = false;
  std::string figures;  // folder for the SVG files; empty: none
  std::string traces;   // CSV file for the first operator's ticks; empty: none
  std::string hand;     // recorded hand in place of simulated ones; empty: none
};

struct WrenchCommand : WallCommand {
  WrenchCommand() { scene = "wrench"; }
  std::optional<double> c;  // of (2.2) [N s/(m rad)]; unset: the scene's
  int turns = 4;
  int loosen = 0;
};

struct GearshiftCommand : WallCommand {
  GearshiftCommand() { scene = "gearshift"; }
};

// Exit codes: 0 done, 1 an output could not be written, 2 bad file or usage, 130 cancelled. Results
// go to the standard output, progress and errors to the error output. `cancelled` is raised from
// outside, as by Ctrl-C.
int run_wrench_command(const WrenchCommand& command, const std::atomic<bool>& cancelled);
int run_gearshift_command(const GearshiftCommand& command, const std::atomic<bool>& cancelled);

}  // namespace handrail
