#include "server/lab/scenes/stability.h"

#include <cmath>

#include "devices/joystick/joystick_data.h"
#include "devices/omni/omni_data.h"
#include "proto/rendering.pb.h"
#include "server/base/units.h"
#include "server/master/governing.h"
#include "server/scene/json_io.h"

namespace handrail {
namespace {

HapticCapabilities device_for(const Scene& scene) {
  return scene.walls ? joystick_capabilities() : omni_capabilities(false);
}

}  // namespace

std::string stability_text(const Scene& scene) {
  const HapticCapabilities device = device_for(scene);
  std::string out;
  for (const std::string& line : stability_lines(check_renderings(scene, device), device, true)) {
    out += line + '\n';
  }
  return out;
}

std::string stability_json(const Scene& scene) {
  const HapticCapabilities device = device_for(scene);
  pb::RenderingReport report;
  report.set_scene(scene.name);
  report.set_device(device.name);
  pb::DeclaredDevice& declared = *report.mutable_declared();
  declared.set_mass_kg(device.dynamics.mass);
  declared.set_damping_n_s_per_m(device.dynamics.damping);
  declared.set_friction_n(device.dynamics.friction);
  declared.set_counts_mm(device.dynamics.resolution / kMm);
  declared.set_delay_ms(1e3 * device.dynamics.delay);
  declared.set_source(device.dynamics.source);
  for (const CheckedRendering& c : check_renderings(scene, device)) {
    pb::CheckedRendering& out = *report.add_renderings();
    out.set_name(c.rendering.name);
    out.set_stiffness_n_per_mm(c.rendering.stiffness / kNewtonPerMm);
    out.set_damping_n_s_per_m(c.rendering.damping);
    out.set_delay_ms(1e3 * c.rendering.delay);
    if (std::isfinite(c.margin.share)) out.set_margin(c.margin.share);
    out.set_limited_by(name_of(c.margin.by));
    out.set_governed_share(c.share);
    out.set_governed_damping_share(c.damping_share);
    out.set_energy_bounded(c.bounded);
  }
  return json_text(report, false) + '\n';
}

}  // namespace handrail
