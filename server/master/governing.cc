#include "server/master/governing.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "server/base/units.h"

namespace handrail {
namespace {

std::string times(double share) {
  return std::isfinite(share) ? fmt::format("{:.3g} times", share) : "any number of times";
}

std::string what(const Rendering& r) {
  std::string out = fmt::format("{}: {:g} N/mm", r.name, r.stiffness / kNewtonPerMm);
  if (r.damping > 0.0) out += fmt::format(", {:.3g} N s/m", r.damping);
  if (r.delay > 0.0) out += fmt::format(", {:g} ms late", 1e3 * r.delay);
  return out;
}

// What it declares, and by whom.
std::string declared(const HapticCapabilities& device) {
  if (device.max_force <= 0.0)
    return device.name + ": makes no force, walls and tools are not felt";
  const DeviceDynamics& d = device.dynamics;
  return fmt::format(
      "{}: mass {:g} kg, damping {:g} N s/m, friction {:g} N, counts {:.3g} mm, delay {:g} ms ({})",
      device.name, d.mass, d.damping, d.friction, d.resolution / kMm, 1e3 * d.delay,
      *d.source ? d.source : "no source given");
}

bool as_it_is(const CheckedRendering& c) {
  const Rendering& r = c.rendering;
  return (c.share >= 1.0 || r.stiffness == 0.0) && (c.damping_share >= 1.0 || r.damping == 0.0);
}

std::string done(const CheckedRendering& c) {
  if (c.bounded) return "rendered as it is, its energy bounded";
  if (as_it_is(c)) return "rendered as it is";
  std::string out =
      fmt::format("rendered at {:.3g} N/mm", c.share * c.rendering.stiffness / kNewtonPerMm);
  if (c.rendering.damping > 0.0) {
    out += fmt::format(", {:.3g} N s/m", c.damping_share * c.rendering.damping);
  }
  const bool by_itself = c.damping_share >= std::min(1.0, kGoverned * c.margin.share);
  return by_itself ? out : out + ", as all come down together";
}

}  // namespace

RenderingLoop rendering_loop(const HapticCapabilities& device) {
  RenderingLoop out;
  out.velocity_lag = device.velocity_lag;
  out.peak = device.max_force;
  out.least_mass = device.least_mass;
  return out;
}

GovernorSettings governor_settings(const HapticCapabilities& device, bool on) {
  GovernorSettings out;
  out.on = on && device.max_force > 0.0;
  out.peak = device.max_force;
  // What a device takes up whose mass, counts or delay are not known is not known either.
  const double late = device.dynamics.delay / out.period;
  const bool known = device.dynamics.mass > 0.0 && device.dynamics.resolution > 0.0;
  if (!(known && late >= 0.0 && late <= kMostForceDelay)) return out;
  out.delay = static_cast<int>(late);
  out.late = late - out.delay;
  out.friction = std::max(device.dynamics.friction, 0.0);
  out.damping = std::max(device.dynamics.damping, 0.0);
  return out;
}

std::vector<CheckedRendering> check_renderings(const Scene& scene,
                                               const HapticCapabilities& device) {
  std::vector<CheckedRendering> out;
  if (device.max_force <= 0.0) return out;  // nothing is rendered at it
  const RenderingLoop loop = rendering_loop(device);
  for (const Rendering& rendering : renderings_of(scene, loop)) {
    CheckedRendering& c = out.emplace_back();
    c.rendering = rendering;
    c.margin = margin_of(device.dynamics, loop, rendering);
    c.bounded = rendering.delay > 0.0;
  }
  const double least = governed_share(out);
  for (CheckedRendering& c : out) {
    if (c.bounded) continue;
    c.share = c.damping_share = least;
    if (scene.walls) continue;
    const double most =
        kGoverned * most_stiffness(device.dynamics, loop, least * c.rendering.damping);
    c.share = c.rendering.stiffness > most ? most / c.rendering.stiffness : 1.0;
  }
  return out;
}

double governed_share(const std::vector<CheckedRendering>& checked) {
  double share = 1.0;
  for (const CheckedRendering& c : checked) {
    if (!c.bounded) share = std::min(share, kGoverned * c.margin.share);
  }
  return share;
}

std::vector<std::string> stability_lines(const std::vector<CheckedRendering>& checked,
                                         const HapticCapabilities& device, bool governor) {
  std::vector<std::string> out{declared(device)};
  for (const CheckedRendering& c : checked) {
    out.push_back(fmt::format("{}; {} holds {} that, by its {}; {}", what(c.rendering), device.name,
                              times(c.margin.share), name_of(c.margin.by),
                              governor ? done(c) : "governor off: rendered as it is"));
  }
  if (device.actuates_torque) {
    out.push_back(
        fmt::format("orientation tools: not checked, {} declares no rotational inertia; "
                    "rendered as they are",
                    device.name));
  }
  return out;
}

std::vector<std::string> stability_warnings(const std::vector<CheckedRendering>& checked,
                                            const HapticCapabilities& device, bool governor) {
  std::vector<std::string> out;
  for (const CheckedRendering& c : checked) {
    if (c.bounded || (governor ? as_it_is(c) : c.margin.share >= 1.0)) continue;
    out.push_back(fmt::format("{}: {} holds {:.3g} N/mm, by its {}: {}", what(c.rendering),
                              device.name, c.margin.share * c.rendering.stiffness / kNewtonPerMm,
                              name_of(c.margin.by), governor ? done(c) : "it may buzz"));
  }
  return out;
}

}  // namespace handrail
