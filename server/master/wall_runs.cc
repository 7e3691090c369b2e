#include "server/master/wall_runs.h"
#include "server/haptic/wall_proxies.h"

#include <spdlog/fmt/fmt.h>

#include "server/base/units.h"

namespace handrail {
namespace {

constexpr std::size_t kKept = 4;
// Largest step of the force a millisecond that no motion explains, share of the device's peak.
constexpr double kStepShare = 0.015;

}  // namespace

std::unique_ptr<WallRun> make_wall_run(const Scene& scene, const HapticCapabilities& device) {
  auto run = std::make_unique<WallRun>();
  run->settings.walls = scene.walls;
  run->settings.force.peak = device.max_force;
  run->settings.force.continuous = device.continuous_force;
  run->settings.force.step = kStepShare * device.max_force;
  run->settings.device = device_effects(scene.effects);
  Plant plant;
  plant.least_mass = device.least_mass;
  plant.velocity_lag = device.velocity_lag;
  plant.most_force = device.max_force;
  run->state.effects = EffectStack(scene.effects, plant);
  run->state.proxy = make_wall_proxy(*scene.walls);
  return run;
}

std::vector<std::string> wall_warnings(const Scene& scene, const HapticCapabilities& device) {
  std::vector<std::string> out;
  if (!scene.walls) return out;
  for (const WallRegion& region : scene.walls->regions) {
    if (region.kind != RegionKind::kWall || region.stiffness <= device.max_stiffness) continue;
    out.push_back(fmt::format(
        "wall '{}': {:g} N/mm is more than the {:g} N/mm that {} renders stably: it may buzz",
        region.name, region.stiffness / kNewtonPerMm, device.max_stiffness / kNewtonPerMm,
        device.name));
  }
  return out;
}

WallRun* WallRuns::make(const Scene& scene, const HapticCapabilities& device) {
  if (!scene.walls) return nullptr;
  if (runs_.size() == kKept) runs_.pop_front();
  return runs_.emplace_back(make_wall_run(scene, device)).get();
}

}  // namespace handrail
