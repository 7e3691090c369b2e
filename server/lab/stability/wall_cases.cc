// The families of cells.
#include <spdlog/fmt/fmt.h>

#include <array>
#include <string>
#include <utility>

#include "server/base/units.h"
#include "server/lab/stability/stability_case.h"
#include "server/lab/stability/wall_cell.h"

namespace handrail {
namespace {

constexpr std::array kForms = {std::pair{WallForm::kWall, "wall"},
                               std::pair{WallForm::kCorner, "corner"},
                               std::pair{WallForm::kThin, "thin"}};

// Collects cells, each without and with what the master does for stability.
class Cells {
 public:
  explicit Cells(std::string family) : family_(std::move(family)) {}

  // For every device and grip; `add` calls put() with what it makes of the cell.
  template <typename Add>
  void each(const Add& add) {
    for (const BenchDevice& device : bench_devices()) {
      for (const GripKind grip : kGripKinds) {
        WallCell cell;
        cell.device = &device;
        cell.grip = grip;
        add(cell);
      }
    }
  }
  void put(WallCell cell, const std::string& what) {
    for (const auto& [governing, name] : kGoverning) {
      cell.governing = governing;
      out_.push_back({fmt::format("{}/{}/{}/{}/{}", family_, cell.device->name, name_of(cell.grip),
                                  what, name),
                      governing == Governing::kOn, true,
                      [cell](std::uint64_t seed) { return run_wall_cell(cell, seed); }});
    }
  }
  void move_to(std::vector<StabilityCase>& all) {
    for (StabilityCase& one : out_) all.push_back(std::move(one));
  }

 private:
  std::string family_;
  std::vector<StabilityCase> out_;
};

// A wall that the device is used with, and that asks something of it [N/m].
double usual_stiffness(const WallCell& cell) {
  const std::string name = cell.device->name;
  return name == "joystick" ? 5000.0 : name == "omni" ? 800.0 : 2000.0;
}

void add_walls(std::vector<StabilityCase>& all) {
  Cells cells("walls");
  cells.each([&](WallCell cell) {
    for (const auto& [form, name] : kForms) {
      for (const double n_mm : {0.1, 0.2, 0.5, 0.8, 1.0, 2.0, 5.0, 10.0}) {
        cell.form = form;
        cell.stiffness = n_mm * kNewtonPerMm;
        cells.put(cell, fmt::format("{}/K{:g}", name, n_mm));
      }
    }
  });
  cells.move_to(all);
}

// The governor then takes back all that is made, though the device takes some by itself. On a
// device without damping nothing can be shown to hold then, and nothing is rendered.
void add_undeclared(std::vector<StabilityCase>& all) {
  Cells cells("undeclared");
  cells.each([&](WallCell cell) {
    if (cell.device->body().damping == 0.0) return;
    cell.declared = false;
    for (const auto& [form, name] : kForms) {
      for (const double n_mm : {0.5, 1.0, 2.0}) {
        cell.form = form;
        cell.stiffness = n_mm * kNewtonPerMm;
        cells.put(cell, fmt::format("{}/K{:g}", name, n_mm));
      }
    }
  });
  cells.move_to(all);
}

void add_rates(std::vector<StabilityCase>& all) {
  Cells cells("rates");
  cells.each([&](WallCell cell) {
    for (const double n_mm : {0.8, 5.0}) {
      for (const double hz : {250.0, 500.0, 1000.0, 2000.0, 4000.0, 10000.0}) {
        cell.stiffness = n_mm * kNewtonPerMm;
        cell.rate = hz;
        cells.put(cell, fmt::format("K{:g}/{:g}Hz", n_mm, hz));
      }
    }
  });
  cells.move_to(all);
}

void add_late_ticks(std::vector<StabilityCase>& all) {
  Cells cells("late-ticks");
  cells.each([&](WallCell cell) {
    cell.stiffness = usual_stiffness(cell);
    for (const auto& [lateness, name] :
         {std::pair{Lateness::kRandom, "random"}, std::pair{Lateness::kPeriodic, "periodic"}}) {
      for (const double ms : {1.0, 2.0, 5.0, 10.0, 20.0}) {
        cell.lateness = lateness;
        cell.gap = 1e-3 * ms;
        cells.put(cell, fmt::format("{}/{:g}ms", name, ms));
      }
    }
  });
  cells.move_to(all);
}

void add_delays(std::vector<StabilityCase>& all) {
  Cells cells("delays");
  cells.each([&](WallCell cell) {
    // What friction alone holds goes with the square of the delay: on the Omni 3 N/m at 10 ms.
    cell.most_softer = 1000.0;
    for (const double n_mm : {0.2, 0.8, 2.0}) {
      for (const int ticks : {1, 2, 5, 10}) {
        cell.stiffness = n_mm * kNewtonPerMm;
        cell.delay = ticks;
        cells.put(cell, fmt::format("K{:g}/{}ms", n_mm, ticks));
      }
    }
  });
  cells.move_to(all);
}

void add_encoders(std::vector<StabilityCase>& all) {
  constexpr double kCount = 0.05e-3;  // chosen, about what both devices have [m]
  Cells cells("encoder");
  cells.each([&](WallCell cell) {
    cell.stiffness = usual_stiffness(cell);
    cell.damped = true;
    for (const double counts : {0.0, 1.0, 4.0, 10.0}) {
      for (const double hz : {0.0, 30.0, 100.0}) {
        cell.resolution = counts * kCount;
        cell.cutoff = hz;
        cells.put(cell, fmt::format("{:g}um/{}", 1e6 * cell.resolution,
                                    hz > 0.0 ? fmt::format("{:g}Hz", hz) : "raw"));
      }
    }
  });
  cells.move_to(all);
}

void add_impacts(std::vector<StabilityCase>& all) {
  Cells cells("impact");
  cells.each([&](WallCell cell) {
    cell.stiffness = usual_stiffness(cell);
    for (const auto& [form, name] : kForms) {
      for (const double speed : {0.1, 0.2, 0.5, 1.0, 2.0}) {
        cell.form = form;
        cell.kick = speed;
        cells.put(cell, fmt::format("{}/{:g}m_s", name, speed));
      }
    }
  });
  cells.move_to(all);
}

// None, each and every pair of what the master's step does.
void add_effects(std::vector<StabilityCase>& all) {
  std::vector<std::pair<std::vector<EffectKind>, std::string>> sets = {{{}, "none"}};
  std::vector<EffectKind> kinds;
  for (int i = 0; i < static_cast<int>(EffectKind::kCount); ++i) {
    const auto kind = static_cast<EffectKind>(i);
    if (!is_of_device(kind)) kinds.push_back(kind);
  }
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    sets.push_back({{kinds[i]}, name_of(kinds[i])});
    for (std::size_t j = i + 1; j < kinds.size(); ++j) {
      sets.push_back(
          {{kinds[i], kinds[j]}, std::string(name_of(kinds[i])) + "+" + name_of(kinds[j])});
    }
  }
  Cells cells("effects");
  cells.each([&](WallCell cell) {
    cell.stiffness = usual_stiffness(cell);
    cell.at_wall = false;
    for (const auto& [effects, name] : sets) {
      cell.effects = effects;
      cells.put(cell, name);
    }
  });
  cells.move_to(all);
}

}  // namespace

std::vector<StabilityCase> wall_cases() {
  std::vector<StabilityCase> out;
  add_walls(out);
  add_undeclared(out);
  add_rates(out);
  add_late_ticks(out);
  add_delays(out);
  add_encoders(out);
  add_impacts(out);
  add_effects(out);
  return out;
}

}  // namespace handrail
