// handrail-lab bumper: maps of both bumpers.
#pragma once

#include <atomic>
#include <string>

#include "server/base/status.h"
#include "server/lab/contact/bumper_map.h"

namespace handrail {

struct BumperCommand {
  std::string arm;     // rigid, rig; empty: both
  std::string form;    // published, default; empty: both
  double noise = 0.0;  // [N]
  int threads = 0;
  bool json = false;
  std::string figures;  // folder; empty: none
};

// A LabExit; kFailed where the default form breaks a promise.
int run_bumper_command(const BumperCommand& command, const std::atomic<bool>& cancelled);

// Draws the maps side by side into FOLDER/bumper-maps.svg.
Status draw_bumper(const std::string& folder, const std::vector<BumperMap>& maps);

}  // namespace handrail
