#include "server/lab/stability/teleop_map.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "server/base/units.h"
#include "server/lab/figure/figure.h"
#include "server/lab/stability/bench_device.h"
#include "server/lab/stability/teleop_cell.h"
#include "server/lab/study/parallel.h"

namespace handrail {
namespace {

using figure::Axis;
using figure::Panel;
using figure::Point;

constexpr std::array kMapTrips = {0.0, 10.0, 50.0, 100.0, 200.0, 500.0, 1000.0};  // [ms]
constexpr std::array kMapLosses = {0.0, 0.1, 0.3, 0.5};
constexpr std::array kMapHands = {kLightest, 250.0, kFirmest};  // [N/m]
constexpr std::array kMapGrounds = {1e3, 10e3, 50e3};           // [N/m]
constexpr double kFeltAt = kMapGrounds.back();                  // where stiffness is told [N/m]

// What a place came to; not a number where nothing engaged.
struct PlaceFigures {
  int cells = 0, stable = 0, felt_cells = 0, deep_cells = 0;
  double felt = 0.0, error = 0.0;  // sums [N/mm], [N]
  double drift = 0.0;              // most [mm]

  void add(const TeleopCell& cell, const TeleopFigures& f) {
    ++cells;
    stable += f.stable();
    if (!f.refused.empty()) return;
    drift = std::max(drift, f.drift / kMm);
    if (cell.stiffness != kFeltAt) return;
    ++felt_cells;
    deep_cells += f.felt > 0.0;
    felt += f.felt / kNewtonPerMm;
    error += f.error;
  }
  double share() const { return cells > 0 ? 100.0 * stable / cells : std::nan(""); }
  static double mean(double sum, int cells) { return cells > 0 ? sum / cells : std::nan(""); }
};

struct Quantity {
  const char* title;
  const char* label;
  double (*of)(const PlaceFigures&);
  int decimals;
};
const std::array kQuantities = {
    Quantity{"stable", "cells [%]", [](const PlaceFigures& f) { return f.share(); }, 0},
    Quantity{"displayed, second touch", "stiffness [N/mm]",
             [](const PlaceFigures& f) { return f.mean(f.felt, f.deep_cells); }, 2},
    Quantity{"force error, second touch", "rms [N]",
             [](const PlaceFigures& f) { return f.mean(f.error, f.felt_cells); }, 2},
    Quantity{"drift after a touch, most", "at the tip [mm]",
             [](const PlaceFigures& f) { return f.drift; }, 2}};

// [model][loss][trip]
using PlaceTable =
    std::array<std::array<std::array<PlaceFigures, kMapTrips.size()>, kMapLosses.size()>, 2>;

struct MapCell {
  TeleopCell cell;
  std::size_t model, loss, trip;
  TeleopFigures figures;
};

std::vector<MapCell> map_cells() {
  std::vector<MapCell> out;
  for (std::size_t model = 0; model < 2; ++model) {
    for (std::size_t loss = 0; loss < kMapLosses.size(); ++loss) {
      for (std::size_t trip = 0; trip < kMapTrips.size(); ++trip) {
        for (const double hand : kMapHands) {
          for (const double ground : kMapGrounds) {
            TeleopCell cell;
            cell.round_trip = 1e-3 * kMapTrips[trip];
            cell.faults.loss = kMapLosses[loss];
            cell.later = true;
            cell.grip = hand;
            cell.stiffness = ground;
            cell.local = model == 1;
            out.push_back({cell, model, loss, trip, {}});
          }
        }
      }
    }
  }
  return out;
}

std::string name_of_loss(std::size_t loss) {
  return fmt::format("{:g} % lost", 100.0 * kMapLosses[loss]);
}
const char* name_of_way(std::size_t model) { return model == 0 ? "by the spring" : "by the model"; }

// Both panels of a quantity have the same axis: they are there to be compared.
double most_of(const PlaceTable& table, const Quantity& quantity) {
  double most = 0.0;
  for (const auto& way : table) {
    for (const auto& loss : way) {
      for (const PlaceFigures& place : loss) most = std::fmax(most, quantity.of(place));
    }
  }
  return most;
}

Panel panel_of(const PlaceTable& table, const Quantity& quantity, std::size_t model) {
  std::vector<std::string> trips;
  for (const double trip : kMapTrips) trips.push_back(fmt::format("{:g}", trip));
  Panel panel(fmt::format("{}, {}", quantity.title, name_of_way(model)),
              Axis{.label = "round trip [ms]", .categories = trips},
              Axis{.label = quantity.label, .low = 0.0, .high = 1.05 * most_of(table, quantity)});
  for (std::size_t loss = 0; loss < kMapLosses.size(); ++loss) {
    std::vector<Point> points;
    for (std::size_t trip = 0; trip < kMapTrips.size(); ++trip) {
      points.push_back({static_cast<double>(trip + 1), quantity.of(table[model][loss][trip])});
    }
    panel.line(points, figure::style_of(loss), name_of_loss(loss));
    panel.points(std::move(points), figure::style_of(loss), name_of_loss(loss));
  }
  return panel;
}

std::string number_of(const Quantity& quantity, const PlaceFigures& place) {
  const double value = quantity.of(place);
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, quantity.decimals) : "-";
}

// By the spring / by the model.
std::string text_of(const PlaceTable& table) {
  std::string out = "| by the spring / by the model | |";
  for (const double trip : kMapTrips) out.append(fmt::format(" {:g} ms |", trip));
  out.append("\n|---|---|");
  for (std::size_t i = 0; i < kMapTrips.size(); ++i) out.append("---|");
  out.append("\n");
  for (const Quantity& quantity : kQuantities) {
    for (std::size_t loss = 0; loss < kMapLosses.size(); ++loss) {
      out.append(
          fmt::format("| {}, {} | {} |", quantity.title, quantity.label, name_of_loss(loss)));
      for (std::size_t trip = 0; trip < kMapTrips.size(); ++trip) {
        out.append(fmt::format(" {} / {} |", number_of(quantity, table[0][loss][trip]),
                               number_of(quantity, table[1][loss][trip])));
      }
      out.append("\n");
    }
  }
  return out;
}

}  // namespace

Result<bool> draw_teleop_map(const std::string& folder, const StabilityMapOptions& options,
                             std::string& table) {
  std::vector<MapCell> cells = map_cells();
  const bool done = run_parallel(
      cells.size(), options.threads,
      [&](std::size_t i) { cells[i].figures = measure_teleop(cells[i].cell, 1); },
      [&](std::size_t n) {
        if (options.progress) options.progress(n, cells.size());
      },
      options.cancelled);
  if (!done) return false;
  PlaceTable places;
  for (const MapCell& one : cells) {
    places[one.model][one.loss][one.trip].add(one.cell, one.figures);
  }
  table = text_of(places);
  figure::Figure figure("Teleoperation across delay and loss",
                        "both sides' own steps; three hands at surfaces of 1, 10 and 50 N/mm, "
                        "kicked; stiffness and force at 50 N/mm");
  for (const Quantity& quantity : kQuantities) {
    for (std::size_t model = 0; model < 2; ++model) figure.add(panel_of(places, quantity, model));
  }
  if (Status s = figure.write_file(folder + "/delay-loss-map.svg"); !s) return s;
  return true;
}

}  // namespace handrail
