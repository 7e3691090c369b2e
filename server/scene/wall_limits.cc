#include "server/scene/wall_limits.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/base/units.h"
#include "server/scene/field_check.h"

namespace handrail {

double stiffness_limit(const WallDevice& device, double wall_damping) noexcept {
  double limit = std::numeric_limits<double>::infinity();
  const auto offer = [&](bool known, double stiffness) {
    if (known) limit = std::min(limit, std::max(stiffness, 0.0));
  };
  offer(device.damping > 0.0, 2.0 * (device.damping - std::abs(wall_damping)) / device.period);
  offer(device.friction > 0.0 && device.resolution > 0.0,
        2.0 * device.friction / device.resolution);
  offer(device.max_stiffness > 0.0, device.max_stiffness);
  return limit;
}

std::vector<std::string> stiffness_warnings(const Walls& walls, const WallDevice& device) {
  std::vector<std::string> out;
  const auto n_mm = [](double stiffness) {
    return number_text(std::round(stiffness / kNewtonPerMm * 100.0) / 100.0) + " N/mm";
  };
  for (const WallRegion& region : walls.regions) {
    if (region.kind != RegionKind::kWall) continue;
    const double limit = stiffness_limit(device, region.damping);
    if (region.stiffness <= limit) continue;
    out.push_back("wall '" + region.name + "': the device holds " + n_mm(limit) + ", not " +
                  n_mm(region.stiffness) + ": it may buzz under a light hand");
  }
  return out;
}

}  // namespace handrail
