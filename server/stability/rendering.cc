#include "server/stability/rendering.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "server/stability/sampled_wall.h"

namespace handrail {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();
constexpr double kLongestDelay = 2000.0;  // the polynomial's work goes with its square [periods]
constexpr double kRounded = 1e-9;         // of a period: so much beyond whole ones is rounding
// By how much the dampers of sliders and pawls, and those of detents at half their pull, make up
// for a spring that is held: shares of K T, as in server/effects.
constexpr double kSliderDamping = 0.75, kDetentDamping = 0.375;

bool usable(double value) { return value >= 0.0 && value < kUnlimited; }

std::optional<SampledWall> sampled(const DeviceDynamics& device, const RenderingLoop& loop,
                                   const Rendering& r) {
  for (const double value : {device.mass, device.damping, device.friction, device.resolution,
                             device.delay, r.stiffness, r.damping, r.delay, loop.velocity_lag}) {
    if (!usable(value)) return std::nullopt;
  }
  if (!(loop.period > 0.0 && usable(loop.period) && loop.peak > 0.0)) return std::nullopt;
  // What a rendering is late by itself is taken to be whole periods, no shorter than it is.
  const double own = std::max(std::ceil(r.delay / loop.period - kRounded), 0.0);
  const double whole = std::floor(device.delay / loop.period + kRounded);
  if (own + whole > kLongestDelay) return std::nullopt;
  SampledWall out{.mass = device.mass, .damping = device.damping, .period = loop.period};
  out.wall_damping = r.damping;
  out.delay = static_cast<int>(own + whole);
  const double part = device.delay / loop.period - whole;
  out.late = part > kRounded ? part : 0.0;
  if (!r.own_velocity && loop.velocity_lag > 0.0) {
    out.velocity_pole = std::exp(-loop.period / loop.velocity_lag);
  }
  return out;
}

// The largest share of stiffness and damping together up to which every motion dies away.
double loop_share(const SampledWall& wall, double stiffness) {
  const auto stable = [&](double share) {
    SampledWall part = wall;
    part.wall_damping *= share;
    return is_stable(part, share * stiffness);
  };
  // From below, so that it is the first; less than a thousandth of it is nothing, and the roots
  // come so near to 1 that they cannot be told from it.
  double good = 1e-3;
  if (!stable(good)) return 0.0;
  double bad = 1.1 * good;
  for (; stable(bad); bad *= 1.1) {
    if (bad > 1e6) return kUnlimited;
    good = bad;
  }
  while (bad - good > 1e-9 * bad) {
    const double middle = 0.5 * (good + bad);
    (stable(middle) ? good : bad) = middle;
  }
  return good;
}

// Energy that an oscillation beyond the peak force F makes a cycle beside what friction takes: with
// the amplitude a F / K its speed on the way through the spring is sqrt(2 a - 1 - (x K / F)^2) F /
// sqrt(K m), so that it makes 4 (K t - b) times the integral of that. Beside 4 f_c a F / K that is
// most at a = 1.370, this much times (K t - b) F / (f_c sqrt(K m)); within the peak, a = 1, it is
// pi / 4.
constexpr double kMostMade = 0.86033;

// (K t - b) F kMostMade = f_c sqrt(K m), for sqrt(K).
double stiffness_by_friction(const DeviceDynamics& device, double peak, double late) {
  const double c = device.friction * std::sqrt(device.mass) / kMostMade;
  const double root = std::sqrt(c * c + 4.0 * peak * peak * late * device.damping);
  const double s = (c + root) / (2.0 * peak * late);
  return s * s;
}

// Whether the damper of `wall` takes energy of an oscillation of `stiffness`: what it does is less
// than a quarter of a cycle late. A difference is half a period old, and held for one.
bool damper_takes(const SampledWall& wall, const RenderingLoop& loop, double stiffness) {
  if (wall.wall_damping == 0.0) return true;
  const double w = std::sqrt(stiffness / wall.mass);
  const double filtered = wall.velocity_pole > 0.0 ? std::atan(w * loop.velocity_lag) : 0.0;
  return filtered + w * wall.period * (1.0 + wall.delay + wall.late) < 0.5 * std::numbers::pi;
}

// As margin_of(), for a spring of 1 N/m: the stiffness that friction holds [N/m].
StabilityMargin held_by_friction(const DeviceDynamics& device, const RenderingLoop& loop,
                                 const SampledWall& wall) {
  if (device.resolution == 0.0) return {0.0, StabilityLimit::kFriction};
  const double late = loop.period * (0.5 + wall.delay + wall.late);
  const double grown = stiffness_by_friction(device, loop.peak, late);
  const double counted = 2.0 * device.friction / device.resolution;
  const double held = std::min(grown, counted);
  if (!damper_takes(wall, loop, held)) return {0.0, StabilityLimit::kFriction};
  return {held, counted < grown ? StabilityLimit::kCounts : StabilityLimit::kFriction};
}

// The stiffest spring that the device takes up by its damping alone, delay and all [N/m]. What a
// spring needs is the highest of lines in K, so what is taken up is all from none on.
double passive_stiffness(const DeviceDynamics& device, const SampledWall& wall) {
  if (passive_damping(wall, 0.0) > device.damping) return 0.0;
  // By angle 0, more than which none is; without wall damping just that.
  const double late = 0.5 + wall.delay + (wall.late > 0.0 ? 1.0 : 0.0);
  double good = 0.0, bad = (device.damping + wall.wall_damping) / (late * wall.period);
  if (wall.wall_damping == 0.0) return bad;
  while (bad - good > 1e-9 * bad) {
    const double middle = 0.5 * (good + bad);
    (passive_damping(wall, middle) <= device.damping ? good : bad) = middle;
  }
  return good;
}

Rendering make(std::string name, double stiffness, double damping, bool own_velocity = false) {
  return {std::move(name), stiffness, damping, own_velocity, 0.0};
}

std::optional<Rendering> rendering_of(const EffectSpec& e, double period) {
  const auto named = [&](double stiffness, double share, bool own) {
    return make(std::string("effect '") + name_of(e.kind) + "'", stiffness,
                share * stiffness * period, own);
  };
  switch (e.kind) {
    case EffectKind::kReturn: return named(e.stiffness, 0.0, true);
    case EffectKind::kOneWay: return named(e.stiffness, kSliderDamping, true);
    case EffectKind::kViscous:
    case EffectKind::kProgressive:
    case EffectKind::kCoulomb: return named(e.coupling, kSliderDamping, true);
    case EffectKind::kDetent: {
      double steepest = e.radii.empty() && e.radius > 0.0 ? 2.0 * e.peak / e.radius : 0.0;
      for (std::size_t i = 0; i < std::min(e.radii.size(), e.peaks.size()); ++i) {
        if (e.radii[i] > 0.0) steepest = std::max(steepest, 2.0 * e.peaks[i] / e.radii[i]);
      }
      return named(steepest, kDetentDamping, false);
    }
    default: return std::nullopt;
  }
}

std::optional<Rendering> rendering_of(const WallRegion& region, const std::string& stage,
                                      bool published_damper, const RenderingLoop& loop) {
  if (region.kind != RegionKind::kWall) return std::nullopt;
  const double h = published_damper ? 0.0 : loop.period + loop.velocity_lag;
  return make("wall '" + region.name + "'" + (stage.empty() ? "" : " in stage '" + stage + "'"),
              region.stiffness, region.damping / (1.0 + region.damping * h / loop.least_mass));
}

// Each wall, and each that a stage makes another.
std::vector<Rendering> of_regions(const Walls& walls, bool published_damper,
                                  const RenderingLoop& loop) {
  std::vector<Rendering> out;
  const auto add = [&](const WallRegion& region, const std::string& stage) {
    if (const auto wall = rendering_of(region, stage, published_damper, loop)) out.push_back(*wall);
  };
  for (const WallRegion& region : walls.regions) add(region, "");
  for (const WallStage& stage : walls.stages) {
    for (std::size_t i = 0; i < stage.regions.size(); ++i) {
      const WallRegion &now = stage.regions[i], &listed = walls.regions[i];
      const bool same = now.stiffness == listed.stiffness && now.damping == listed.damping;
      if (!same) add(now, stage.name);
    }
  }
  return out;
}

// With the largest peak that a stage gives each place.
EffectSpec hardest(const EffectSpec& e, const Walls& walls) {
  EffectSpec out = e;
  if (e.kind != EffectKind::kDetent) return out;
  for (const WallStage& stage : walls.stages) {
    if (stage.detent_peaks.size() != e.places.size()) continue;
    out.radii.resize(e.places.size(), e.radius);
    out.peaks.resize(e.places.size(), e.peak);
    for (std::size_t i = 0; i < e.places.size(); ++i) {
      out.peaks[i] = std::max(out.peaks[i], stage.detent_peaks[i]);
    }
  }
  return out;
}

std::vector<Rendering> of_walls(const Scene& scene, const RenderingLoop& loop) {
  std::vector<Rendering> out;
  Rendering most;
  const auto rendered =
      std::find_if(scene.effects.begin(), scene.effects.end(),
                   [](const EffectSpec& e) { return e.kind == EffectKind::kWall; });
  if (rendered != scene.effects.end()) {
    out = of_regions(*scene.walls, rendered->published_damper, loop);
  }
  for (const Rendering& wall : out) {
    if (wall.stiffness >= most.stiffness) most = wall;
  }
  for (const EffectSpec& e : scene.effects) {
    const std::optional<Rendering> effect = rendering_of(hardest(e, *scene.walls), loop.period);
    if (!effect) continue;
    out.push_back(*effect);
    most.own_velocity = most.own_velocity || (most.damping == 0.0 && effect->own_velocity);
    most.stiffness += effect->stiffness;
    most.damping += effect->damping;
  }
  if (out.size() > 1) {
    most.name = "all together";
    out.push_back(most);
  }
  return out;
}

std::vector<Rendering> of_tools(const Scene& scene, const RenderingLoop& loop) {
  std::vector<Rendering> out;
  const Scene::Guidance& g = scene.guidance;
  out.push_back(make("position tools", g.stiffness, g.damping));
  for (const ToolCall& call : scene.tools) {
    if (!is_position_tool(call.kind) || call.stiffness == 0.0) continue;
    out.push_back(
        make(std::string("tool '") + name_of(call.kind) + "'", call.stiffness, g.damping));
  }
  Rendering spring = make("spring to the tip", g.spring, 0.0);
  // Of the mean of the last samples: to a tip that stands it is as old as their middle.
  spring.delay = 0.5 * (scene.smoother_samples - 1) * loop.period;
  out.push_back(spring);
  return out;
}

}  // namespace

const char* name_of(StabilityLimit limit) noexcept {
  constexpr std::array<const char*, 5> kNames = {"loop", "friction", "counts", "mass not declared",
                                                 "invalid device data"};
  return kNames[std::min(static_cast<std::size_t>(limit), kNames.size() - 1)];
}

StabilityMargin margin_of(const DeviceDynamics& device, const RenderingLoop& loop,
                          const Rendering& rendering) {
  const std::optional<SampledWall> wall = sampled(device, loop, rendering);
  if (!wall) return {};
  if (rendering.stiffness == 0.0 && rendering.damping == 0.0) {
    return {kUnlimited, StabilityLimit::kLoop};
  }
  if (device.mass == 0.0) {
    const double needed = passive_damping(*wall, rendering.stiffness);
    return {needed > 0.0 ? device.damping / needed : kUnlimited, StabilityLimit::kUnknown};
  }
  // A damper alone leaves the hand where it is: next to no spring brings it back.
  const double softest = 1e-6 * device.mass / (loop.period * loop.period);
  StabilityMargin out{loop_share(*wall, std::max(rendering.stiffness, softest)),
                      StabilityLimit::kLoop};
  if (rendering.stiffness == 0.0) return out;
  StabilityMargin held = held_by_friction(device, loop, *wall);
  held.share /= rendering.stiffness;
  return held.share > out.share ? held : out;
}

double most_stiffness(const DeviceDynamics& device, const RenderingLoop& loop, double damping) {
  const Rendering unit = make("", 1.0, damping);
  const std::optional<SampledWall> wall = sampled(device, loop, unit);
  if (!wall) return 0.0;
  if (device.mass == 0.0) return passive_stiffness(device, *wall);
  return std::max(stiffness_onset(*wall), held_by_friction(device, loop, *wall).share);
}

double most_surface_stiffness(const DeviceDynamics& device, const RenderingLoop& loop,
                              double damping) {
  return std::min(most_stiffness(device, loop, 0.0), most_stiffness(device, loop, damping));
}

std::vector<Rendering> renderings_of(const Scene& scene, const RenderingLoop& loop) {
  return scene.walls ? of_walls(scene, loop) : of_tools(scene, loop);
}

std::vector<Rendering> touched_of(const Scene& scene) {
  if (scene.walls || !scene.guidance.local_surface) return {};
  return {make("surface that is touched", scene.guidance.stiffness, 0.0)};
}

std::vector<Rendering> turnings_of(const Scene& scene) {
  std::vector<Rendering> out;
  if (scene.walls) return out;
  out.push_back(make("orientation tools", scene.guidance.torque_stiffness, 0.0));
  for (const ToolCall& call : scene.tools) {
    if (is_position_tool(call.kind) || call.stiffness == 0.0) continue;
    out.push_back(make(std::string("tool '") + name_of(call.kind) + "'", call.stiffness, 0.0));
  }
  for (Rendering& r : out) r.turns = true;
  return out;
}

}  // namespace handrail
