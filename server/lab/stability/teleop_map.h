// A map of delay and loss: what of the whole teleoperation is stable, and what it feels like.
#pragma once

#include <string>

#include "server/base/status.h"
#include "server/lab/stability/stability_map.h"

namespace handrail {

// Each place is nine cells: three hands at surfaces of 1, 10 and 50 N/mm, engaged over the delay
// before datagrams are lost. Writes FOLDER/delay-loss-map.svg, and to `table` the same in Markdown.
// False and no file when cancelled.
Result<bool> draw_teleop_map(const std::string& folder, const StabilityMapOptions& options,
                             std::string& table);

}  // namespace handrail
