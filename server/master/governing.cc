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

// With its unit.
std::string stiffness_text(const Rendering& r, double share) {
  return r.turns ? fmt::format("{:.3g} N m/rad", share * r.stiffness)
                 : fmt::format("{:.3g} N/mm", share * r.stiffness / kNewtonPerMm);
}

std::string what(const Rendering& r) {
  std::string out = r.turns ? fmt::format("{}: {:g} N m/rad", r.name, r.stiffness)
                            : fmt::format("{}: {:g} N/mm", r.name, r.stiffness / kNewtonPerMm);
  if (r.damping > 0.0) out += fmt::format(", {:.3g} N s/m", r.damping);
  if (r.delay > 0.0) out += fmt::format(", {:g} ms late", 1e3 * r.delay);
  return out;
}

const char* source_of(const DeviceDynamics& d) { return *d.source ? d.source : "no source given"; }

// What it declares, and by whom.
std::vector<std::string> declared(const HapticCapabilities& device) {
  if (device.max_force <= 0.0)
    return {device.name + ": makes no force, walls and tools are not felt"};
  const DeviceDynamics &d = device.dynamics, &t = device.turning;
  std::vector<std::string> out = {fmt::format(
      "{}: mass {:g} kg, damping {:g} N s/m, friction {:g} N, counts {:.3g} mm, delay {:g} ms ({})",
      device.name, d.mass, d.damping, d.friction, d.resolution / kMm, 1e3 * d.delay, source_of(d))};
  if (!device.actuates_torque) return out;
  out.push_back(fmt::format(
      "{}, turned: inertia {:.3g} kg m^2, damping {:g} N m s/rad, friction {:g} N m, counts {:.3g} "
      "deg, delay {:g} ms ({})",
      device.name, t.mass, t.damping, t.friction, t.resolution / kDeg, 1e3 * t.delay,
      source_of(t)));
  return out;
}

bool as_it_is(const CheckedRendering& c) {
  const Rendering& r = c.rendering;
  return (c.share >= 1.0 || r.stiffness == 0.0) && (c.damping_share >= 1.0 || r.damping == 0.0);
}

std::string done(const CheckedRendering& c) {
  if (c.bounded) return "rendered as it is, its energy bounded";
  if (as_it_is(c)) return "rendered as it is";
  std::string out = "rendered at " + stiffness_text(c.rendering, c.share);
  if (c.rendering.damping > 0.0) {
    out += fmt::format(", {:.3g} N s/m", c.damping_share * c.rendering.damping);
  }
  const bool by_itself = c.damping_share >= std::min(1.0, kGoverned * c.margin.share);
  return by_itself ? out : out + ", as all come down together";
}

GovernorSettings governor_of(const DeviceDynamics& device, double peak, bool on) {
  GovernorSettings out;
  out.on = on && peak > 0.0;
  out.peak = peak;
  const double late = device.delay / out.period;
  if (!(late >= 0.0 && late <= kMostForceDelay)) return out;
  out.delay = static_cast<int>(late);
  out.late = late - out.delay;
  // What a device takes up whose mass or counts are not known is not known either.
  if (!(device.mass > 0.0 && device.resolution > 0.0)) return out;
  out.friction = std::max(device.friction, 0.0);
  out.damping = std::max(device.damping, 0.0);
  return out;
}

// All of it rendered.
CheckedRendering checked_on(const DeviceDynamics& device, const RenderingLoop& loop,
                            const Rendering& rendering) {
  CheckedRendering out;
  out.rendering = rendering;
  out.margin = margin_of(device, loop, rendering);
  out.bounded = rendering.delay > 0.0;
  return out;
}

// What is left of a spring where none stiffer than `most` is rendered.
double share_within(double most, const Rendering& rendering) {
  return rendering.stiffness > most ? most / rendering.stiffness : 1.0;
}

}  // namespace

RenderingLoop rendering_loop(const HapticCapabilities& device) {
  RenderingLoop out;
  out.velocity_lag = device.velocity_lag;
  out.peak = device.max_force;
  out.least_mass = device.least_mass;
  return out;
}

RenderingLoop turning_loop(const HapticCapabilities& device) {
  RenderingLoop out;
  out.peak = device.max_torque;
  return out;
}

GovernorSettings governor_settings(const HapticCapabilities& device, bool on) {
  return governor_of(device.dynamics, device.max_force, on);
}

GovernorSettings turn_governor_settings(const HapticCapabilities& device, bool on) {
  return governor_of(device.turning, device.max_torque, on && device.actuates_torque);
}

std::vector<CheckedRendering> check_renderings(const Scene& scene,
                                               const HapticCapabilities& device) {
  std::vector<CheckedRendering> out;
  if (device.max_force <= 0.0) return out;  // nothing is rendered at it
  const RenderingLoop loop = rendering_loop(device);
  for (const Rendering& r : renderings_of(scene, loop)) {
    out.push_back(checked_on(device.dynamics, loop, r));
  }
  const double least = governed_share(out);
  for (CheckedRendering& c : out) {
    if (c.bounded) continue;
    c.share = c.damping_share = least;
    if (scene.walls) continue;
    c.share =
        share_within(kGoverned * most_stiffness(device.dynamics, loop, least * c.rendering.damping),
                     c.rendering);
  }
  for (const Rendering& r : touched_of(scene)) {
    const double damping = least * scene.guidance.damping;
    out.push_back(checked_on(device.dynamics, loop, r));
    out.back().by_itself = true;
    out.back().share =
        share_within(kGoverned * most_surface_stiffness(device.dynamics, loop, damping), r);
  }
  if (!device.actuates_torque) return out;
  const RenderingLoop turns = turning_loop(device);
  const double most = kGoverned * most_stiffness(device.turning, turns, 0.0);
  for (const Rendering& r : turnings_of(scene)) {
    out.push_back(checked_on(device.turning, turns, r));
    out.back().by_itself = true;
    out.back().share = share_within(most, r);
  }
  return out;
}

double governed_share(const std::vector<CheckedRendering>& checked) {
  double share = 1.0;
  for (const CheckedRendering& c : checked) {
    if (!c.bounded && !c.by_itself) share = std::min(share, kGoverned * c.margin.share);
  }
  return share;
}

std::vector<std::string> stability_lines(const std::vector<CheckedRendering>& checked,
                                         const HapticCapabilities& device, bool governor) {
  std::vector<std::string> out = declared(device);
  for (const CheckedRendering& c : checked) {
    out.push_back(fmt::format("{}; {} holds {} that, by its {}; {}", what(c.rendering), device.name,
                              times(c.margin.share), name_of(c.margin.by),
                              governor ? done(c) : "governor off: rendered as it is"));
  }
  return out;
}

std::vector<std::string> stability_warnings(const std::vector<CheckedRendering>& checked,
                                            const HapticCapabilities& device, bool governor) {
  std::vector<std::string> out;
  for (const CheckedRendering& c : checked) {
    if (c.bounded || (governor ? as_it_is(c) : c.margin.share >= 1.0)) continue;
    out.push_back(fmt::format("{}: {} holds {}, by its {}: {}", what(c.rendering), device.name,
                              stiffness_text(c.rendering, c.margin.share), name_of(c.margin.by),
                              governor ? done(c) : "it may buzz"));
  }
  return out;
}

}  // namespace handrail
