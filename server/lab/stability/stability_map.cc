#include "server/lab/stability/stability_map.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <string_view>
#include <tuple>
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

constexpr std::array kStiffnesses = {0.1, 0.15, 0.2, 0.3, 0.5, 0.7, 1.0,
                                     1.5, 2.0,  3.0, 5.0, 7.0, 10.0};  // [N/mm]
constexpr std::array kModes = {std::pair{Governing::kOff, "governor off"},
                               std::pair{Governing::kOn, "governor on"}};
constexpr double kKick = 0.5;      // [m/s]
constexpr double kUsual = 1000.0;  // loop rate [Hz]
// That CHAI3D renders at most: src/devices/CPhantomDevices.cpp, "PHANTOM Omni" [N/mm].
constexpr double kOmniPublished = 0.7;

// What a map has to the right.
struct Across {
  const char* file;
  const char* title;
  Axis axis;
  std::vector<double> places;
  // A loop there: its rate [Hz], and the delay of the force [ticks].
  std::pair<double, int> (*loop)(double place);
};

Across rates() {
  return {"stability-map.svg",
          "Walls that a device without a hand holds, by loop rate and stiffness",
          {.label = "loop rate [Hz]", .scale = Scale::kLog, .low = 200, .high = 12500},
          {250, 500, 1000, 2000, 4000, 10000},
          [](double hz) {
            return std::pair{hz, 0};
          }};
}

Across delays() {
  return {"stability-delay-map.svg",
          "Walls that a device without a hand holds, by the force's delay and stiffness",
          {.label = "delay of the force at 1 kHz [ms]", .low = -0.5, .high = 10.5},
          {0, 1, 2, 3, 5, 7, 10},
          [](double ms) {
            return std::pair{kUsual, static_cast<int>(ms)};
          }};
}

struct Place {
  WallCell cell;
  double across = 0.0;
  std::vector<char> holds;  // by seed
  std::vector<char> soft;   // beyond most_softer, but else it holds; by seed
};

std::vector<Place> places(const Across& across, int seeds) {
  std::vector<Place> out;
  for (const BenchDevice& device : bench_devices()) {
    for (const auto& mode : kModes) {
      for (const double at : across.places) {
        for (const double stiffness : kStiffnesses) {
          Place place;
          place.across = at;
          place.cell.device = &device;
          place.cell.governing = mode.first;
          std::tie(place.cell.rate, place.cell.delay) = across.loop(at);
          place.cell.kick = kKick;
          place.cell.stiffness = stiffness * kNewtonPerMm;
          place.holds.assign(static_cast<std::size_t>(seeds), 0);
          place.soft = place.holds;
          out.push_back(std::move(place));
        }
      }
    }
  }
  return out;
}

void add_theory(Panel& panel, const Across& across, const BenchDevice& device) {
  const DeviceBody body = device.body();
  std::vector<Point> onset, friction;
  for (const double at : across.places) {
    const auto [rate, delay] = across.loop(at);
    const double period = 1.0 / rate;
    SampledWall wall{.mass = body.mass, .damping = body.damping, .period = period};
    wall.delay = delay;
    onset.push_back({at, stiffness_onset(wall) / kNewtonPerMm});
    // speed_that_grows() is the kick's.
    const double taken = body.damping + 4.0 / std::numbers::pi * body.friction / kKick;
    friction.push_back({at, taken / (period * (0.5 + delay)) / kNewtonPerMm});
  }
  if (body.damping > 0.0) {
    panel.line(std::move(onset), figure::kReferenceStyle, "onset by viscous damping");
  }
  figure::Style style = figure::kReferenceStyle;
  if (body.friction > 0.0) {
    style.dash = figure::Dash::kDotted;
    panel.line(std::move(friction), style, fmt::format("and friction, at {:g} m/s", kKick));
  }
  if (std::string_view(device.name) == "omni" && across.loop(across.places[1]).second == 0) {
    panel.points({{kUsual, kOmniPublished}},
                 {.colour = figure::kColours[3], .marker = Marker::kSquare},
                 "published for it: 0.7 N/mm");
  }
}

void add_places(Panel& panel, const BenchDevice& device, Governing governing,
                const std::vector<Place>& all) {
  std::vector<Point> holds, soft, fails;
  for (const Place& place : all) {
    if (place.cell.device != &device || place.cell.governing != governing) continue;
    const auto every = [](const std::vector<char>& runs) {
      return std::all_of(runs.begin(), runs.end(), [](char one) { return one != 0; });
    };
    std::vector<Point>& where = every(place.holds) ? holds : every(place.soft) ? soft : fails;
    where.push_back({place.across, place.cell.stiffness / kNewtonPerMm});
  }
  const auto put = [&panel](std::vector<Point> points, std::size_t colour, Marker marker,
                            const char* what) {
    if (points.empty()) return;
    panel.points(std::move(points), {.colour = figure::kColours[colour], .marker = marker}, what);
  };
  put(std::move(holds), 0, Marker::kCircle, "at most 1 mJ a contact, and no growth");
  put(std::move(soft), 2, Marker::kTriangle, "the same, over 100 times softer than asked for");
  put(std::move(fails), 1, Marker::kCross, "more, or growth");
}

Result<bool> draw(const Across& across, const std::string& folder,
                  const StabilityMapOptions& options) {
  std::vector<Place> all = places(across, options.seeds);
  const auto seeds = static_cast<std::size_t>(options.seeds);
  const bool done = run_parallel(
      all.size() * seeds, options.threads,
      [&](std::size_t i) {
        Place& place = all[i / seeds];
        const CaseFigures figures = run_wall_cell(place.cell, 1 + i % seeds);
        place.holds[i % seeds] = all_hold(figures) ? 1 : 0;
        place.soft[i % seeds] =
            std::all_of(figures.begin(), figures.end(), [](const CaseFigure& f) {
              return f.holds() || std::string_view(f.name) == "times_softer";
            });
      },
      [&](std::size_t n) {
        if (options.progress) options.progress(n, all.size() * seeds);
      },
      options.cancelled);
  if (!done) return false;
  figure::Figure figure(
      across.title,
      fmt::format("the master's own step at a drawn wall, kicked at {:g} m/s; {} kicks a place",
                  kKick, options.seeds));
  for (const BenchDevice& device : bench_devices()) {
    for (const auto& [governing, name] : kModes) {
      Panel panel(fmt::format("{}, {}", device.name, name), across.axis,
                  Axis{.label = "stiffness [N/mm]", .scale = Scale::kLog, .low = 0.08, .high = 12});
      add_places(panel, device, governing, all);
      add_theory(panel, across, device);
      figure.add(std::move(panel));
    }
  }
  if (Status s = figure.write_file(folder + '/' + across.file); !s) return s;
  return true;
}

}  // namespace

Result<bool> draw_stability_maps(const std::string& folder, const StabilityMapOptions& options) {
  for (const Across& across : {rates(), delays()}) {
    Result<bool> drawn = draw(across, folder, options);
    if (!drawn || !*drawn) return drawn;
  }
  return true;
}

}  // namespace handrail
