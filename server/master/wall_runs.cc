#include "server/master/wall_runs.h"

#include "server/haptic/wall_proxies.h"
#include "server/master/governing.h"
#include "server/master/haptic_settings.h"

namespace handrail {
namespace {

constexpr std::size_t kKept = 4;
// Largest step of the force a millisecond that no motion explains, share of the device's peak.
constexpr double kStepShare = 0.015;

}  // namespace

std::unique_ptr<WallRun> make_wall_run(const Scene& scene, const HapticCapabilities& device,
                                       bool governor) {
  auto run = std::make_unique<WallRun>();
  run->settings.walls = scene.walls;
  run->settings.force.peak = device.max_force;
  run->settings.force.continuous = device.continuous_force;
  run->settings.force.step = kStepShare * device.max_force;
  run->settings.device = device_effects(scene.effects);
  run->settings.governor = governor_settings(device, governor);
  if (governor) run->settings.share = governed_share(check_renderings(scene, device));
  Plant plant;
  plant.least_mass = device.least_mass;
  plant.velocity_lag = device.velocity_lag;
  plant.most_force = device.max_force;
  run->state.effects = EffectStack(scene.effects, plant);
  run->state.proxy = make_wall_proxy(*scene.walls);
  return run;
}

WallRun* WallRuns::make(const Scene& scene, const HapticCapabilities& device, bool governor) {
  if (!scene.walls) return nullptr;
  if (runs_.size() == kKept) runs_.pop_front();
  return runs_.emplace_back(make_wall_run(scene, device, governor)).get();
}

LoopScene loop_scene_of(const Scene& scene, const HapticCapabilities& device,
                        const pb::MasterConfig& config, WallRuns& runs) {
  LoopScene out{haptic_settings(scene, device, config.governor()),
                runs.make(scene, device, config.governor())};
  out.haptic.presence = presence_of(config, device);
  out.haptic.ladder.fade_loop = nanos_of_ms(config.loop_limit_ms());
  out.haptic.ladder.good_for = nanos_of_ms(config.good_link_ms());
  return out;
}

WallReport wall_report(const HapticRun& run) noexcept {
  WallReport shown;
  if (!run.result().has_walls) return shown;
  const WallState& state = run.scene().walls->state;
  const WallOutput& felt = run.result().walls;
  shown.present = true;
  shown.stage = felt.stage;
  shown.contact = felt.contact;
  shown.hand = felt.hand;
  shown.force = state.turn.transpose() * felt.f_H_M.force.head<2>();
  shown.penetration = (felt.contact.proxy - felt.hand).norm();
  shown.locked = felt.effects.locked;
  shown.place = felt.effects.place;
  const auto* screw = state.effects.find<ProgressiveFriction>();
  shown.has_screw = screw != nullptr;
  if (screw == nullptr) return shown;
  shown.turned = screw->alpha();
  shown.screw_c = screw->c();
  return shown;
}

void place_device(const LoopScene& scene, HapticDevice& device) noexcept {
  if (scene.walls == nullptr) return device.simulate(DeviceEffects(), Vec3::Zero());
  const WallSettings& walls = scene.walls->settings;
  const Vec2 start = walls.walls->stages.front().pose.to_world(walls.walls->start);
  device.simulate(walls.device, Vec3(start.x(), start.y(), 0.0));
}

}  // namespace handrail
