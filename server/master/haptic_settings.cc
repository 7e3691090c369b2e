#include "server/master/haptic_settings.h"

#include <algorithm>
#include <limits>

#include "server/master/governing.h"

namespace handrail {
namespace {

constexpr double kToolForceRate = 25.0;  // half of what the arbiter lets pass [N/s]

}  // namespace

HapticSettings haptic_settings(const Scene& scene, const HapticCapabilities& device,
                               bool governor) {
  HapticSettings out;
  out.mapping.scale = scene.mapping.scale;
  out.mapping.R_SM = scene.mapping.R_SM;
  out.mapping.absolute = scene.mapping.absolute;
  out.mapping.hand_centre = scene.mapping.hand_centre;
  out.mapping.tip_centre = scene.mapping.tip_centre;
  out.guide.method =
      scene.guidance.published_method ? GuidanceMethod::kPublished : GuidanceMethod::kExact;
  out.guide.delta = scene.guidance.delta * scene.mapping.scale;
  out.guide.force_rate = kToolForceRate * scene.mapping.scale;
  out.guide.stiffness = scene.guidance.stiffness;
  out.guide.torque_stiffness = scene.guidance.torque_stiffness;
  out.guide.catch_up = scene.guidance.catch_up;
  out.guide.catch_up_rotation = scene.guidance.catch_up_rotation;
  out.guide.chase = scene.guidance.chase;
  out.guide.reach = scene.guidance.tool_reach;
  out.guide.smoother_length = scene.smoother_samples;
  out.damping = scene.guidance.damping;
  double most_of_surface = std::numeric_limits<double>::infinity();
  if (governor && !scene.walls && device.max_force > 0.0) {
    const RenderingLoop loop = rendering_loop(device);
    // A damper that the device does not hold comes down with the scene's tools.
    out.damping *= governed_share(check_renderings(scene, device));
    out.guide.most_stiffness = kGoverned * most_stiffness(device.dynamics, loop, out.damping);
    most_of_surface = kGoverned * most_surface_stiffness(device.dynamics, loop, out.damping);
  }
  if (governor && device.actuates_torque) {
    out.guide.most_torque_stiffness =
        kGoverned * most_stiffness(device.turning, turning_loop(device), 0.0);
  }
  out.governor = governor_settings(device, governor);
  out.turn_governor = turn_governor_settings(device, governor);
  out.spring_stiffness = scene.guidance.spring;
  if (scene.guidance.local_surface)
    out.surface_stiffness = std::min(scene.guidance.stiffness, most_of_surface);
  out.force.peak = device.max_force;
  out.force.continuous = device.continuous_force;
  out.has_torque = device.actuates_torque;
  out.max_torque = device.max_torque;
  out.hashes = section_hashes(scene);
  out.has_arm = !scene.walls;
  out.scene = scene_name(scene.name);
  return out;
}

HandReading hand_reading(const HapticSample& sample) noexcept {
  HandReading out;
  out.X_MH = sample.X_MH;
  out.v_MH = sample.v_MH;
  out.clutch_button = (sample.buttons & 1u) != 0;
  out.drop_button = (sample.buttons & 2u) != 0;
  out.enable_button = (sample.buttons & 4u) != 0;
  out.valid = sample.valid;
  out.force_missed = sample.force_missed;
  return out;
}

Presence presence_of(const pb::MasterConfig& config, const HapticCapabilities& device) {
  if (!config.has_presence()) {
    if (device.simulated && !device.led_by_cursor) return Presence::kNone;
    return device.buttons >= 3 ? Presence::kButton : Presence::kHold;
  }
  switch (config.presence()) {
    case pb::MasterConfig::NONE: return Presence::kNone;
    case pb::MasterConfig::BUTTON: return Presence::kButton;
    case pb::MasterConfig::HOLD: break;
  }
  return Presence::kHold;
}

Nanos nanos_of_ms(double value) { return static_cast<Nanos>(value * 1e6); }

}  // namespace handrail
