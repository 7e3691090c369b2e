// Maps of stiffness and loop rate or delay: where each device holds a wall, and where theory says
// so.
#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "server/base/status.h"

namespace handrail {

struct StabilityMapOptions {
  int seeds = 3;  // of each place; it holds where all do
  int threads = 0;
  const std::atomic<bool>* cancelled = nullptr;
  std::function<void(std::size_t done, std::size_t of)> progress = {};
};

// A row a device without a hand, kicked by half a metre a second at a drawn wall; a column for the
// governor off and one for on. Writes FOLDER/stability-map.svg by rate, and
// stability-delay-map.svg. False, and no file that is not whole, when cancelled.
Result<bool> draw_stability_maps(const std::string& folder, const StabilityMapOptions& options);

}  // namespace handrail
