#include "server/lab/stability/stability_map.h"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <numbers>
#include <utility>
#include <vector>

#include "server/base/units.h"
#include "server/lab/figure/figure.h"
#include "server/lab/stability/wall_cell.h"
#include "server/lab/study/parallel.h"
#include "server/stability/sampled_wall.h"

namespace handrail {
namespace {

using figure::Axis;
using figure::Marker;
using figure::Panel;
using figure::Point;
using figure::Scale;

constexpr std::array kRates = {250.0, 500.0, 1000.0, 2000.0, 4000.0, 10000.0};  // [Hz]
constexpr std::array kStiffnesses = {0.1, 0.15, 0.2, 0.3, 0.5, 0.7, 1.0,
                                     1.5, 2.0,  3.0, 5.0, 7.0, 10.0};  // [N/mm]
constexpr std::array kModes = {std::pair{Governing::kOff, "governor off"},
                               std::pair{Governing::kOn, "governor on"}};
constexpr double kKick = 0.5;  // [m/s]

struct Place {
  WallCell cell;
  std::vector<char> holds;  // by seed
};

std::vector<Place> places(int seeds) {
  std::vector<Place> out;
  for (const BenchDevice& device : bench_devices()) {
    for (const auto& mode : kModes) {
      for (const double rate : kRates) {
        for (const double stiffness : kStiffnesses) {
          Place place;
          place.cell.device = &device;
          place.cell.governing = mode.first;
          place.cell.rate = rate;
          place.cell.kick = kKick;
          place.cell.stiffness = stiffness * kNewtonPerMm;
          place.holds.assign(static_cast<std::size_t>(seeds), 0);
          out.push_back(std::move(place));
        }
      }
    }
  }
  return out;
}

void add_theory(Panel& panel, const BenchDevice& device) {
  const DeviceBody body = device.body();
  std::vector<Point> onset, friction;
  for (const double rate : kRates) {
    const double period = 1.0 / rate;
    onset.push_back(
        {rate, stiffness_onset({.mass = body.mass, .damping = body.damping, .period = period}) /
                   kNewtonPerMm});
    // speed_that_grows() is the kick's.
    const double taken = body.damping + 4.0 / std::numbers::pi * body.friction / kKick;
    friction.push_back({rate, 2.0 * taken / period / kNewtonPerMm});
  }
  if (body.damping > 0.0) {
    panel.line(std::move(onset), figure::kReferenceStyle, "onset by viscous damping");
  }
  if (body.friction > 0.0) {
    figure::Style style = figure::kReferenceStyle;
    style.dash = figure::Dash::kDotted;
    panel.line(std::move(friction), style, fmt::format("and friction, at {:g} m/s", kKick));
  }
}

void add_places(Panel& panel, const BenchDevice& device, Governing governing,
                const std::vector<Place>& all) {
  std::vector<Point> holds, fails;
  for (const Place& place : all) {
    if (place.cell.device != &device || place.cell.governing != governing) continue;
    bool every = true;
    for (const char one : place.holds) every = every && one != 0;
    (every ? holds : fails).push_back({place.cell.rate, place.cell.stiffness / kNewtonPerMm});
  }
  const auto put = [&panel](std::vector<Point> points, std::size_t colour, Marker marker,
                            const char* what) {
    if (points.empty()) return;
    panel.points(std::move(points), {.colour = figure::kColours[colour], .marker = marker}, what);
  };
  put(std::move(holds), 0, Marker::kCircle, "at most 1 mJ a contact, and no growth");
  put(std::move(fails), 1, Marker::kCross, "more, or growth");
}

}  // namespace

Result<bool> draw_stability_map(const std::string& folder, const StabilityMapOptions& options) {
  std::vector<Place> all = places(options.seeds);
  const auto seeds = static_cast<std::size_t>(options.seeds);
  const bool done = run_parallel(
      all.size() * seeds, options.threads,
      [&](std::size_t i) {
        Place& place = all[i / seeds];
        place.holds[i % seeds] = all_hold(run_wall_cell(place.cell, 1 + i % seeds)) ? 1 : 0;
      },
      [&](std::size_t n) {
        if (options.progress) options.progress(n, all.size() * seeds);
      },
      options.cancelled);
  if (!done) return false;
  figure::Figure figure(
      "Walls that a device without a hand holds, by loop rate and stiffness",
      fmt::format("the master's own step at a drawn wall, kicked at {:g} m/s; {} kicks a place",
                  kKick, options.seeds));
  for (const BenchDevice& device : bench_devices()) {
    for (const auto& [governing, name] : kModes) {
      Panel panel(fmt::format("{}, {}", device.name, name),
                  Axis{.label = "loop rate [Hz]", .scale = Scale::kLog, .low = 200, .high = 12500},
                  Axis{.label = "stiffness [N/mm]", .scale = Scale::kLog, .low = 0.08, .high = 12});
      add_places(panel, device, governing, all);
      add_theory(panel, device);
      figure.add(std::move(panel));
    }
  }
  if (Status s = figure.write_file(folder + "/stability-map.svg"); !s) return s;
  return true;
}

}  // namespace handrail
