// Walls: pixel, search radius and method against time.
#pragma once

#include <atomic>
#include <vector>

#include "server/lab/scenes/row.h"
#include "server/model/walls.h"

namespace handrail {

struct WallSetting {
  WallMethod method = WallMethod::kSubpixel;
  double pixel = 1e-4;  // [m]; exact: none
  double radius = 1.5;  // published: epsilon [pixels]
};

// Pixels of 0.4 to 0.025 mm by published at 1.5, 2.5 and 4 pixels and subpixel; then exact.
std::vector<WallSetting> wall_settings();

// Method and setting as a row names them.
const char* name_of(WallMethod method) noexcept;
std::string describe(const WallSetting& setting);

// One row each, on a map as a perfect editor would export it, 8 bits of exact coverage: how far the
// proxy lies off the true wall [um] along the courses of wall_course.h, the hand 1 mm deep and
// 0.1 mm further each tick; time of one update [ns]; memory of proxy and map. The whole error is
// the proxy's from the exact one: times the stiffness it is the force's.
AccuracyRows wall_rows(const std::vector<WallSetting>& settings,
                       const std::atomic<bool>& cancelled);

}  // namespace handrail
