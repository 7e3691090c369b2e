#include "server/scene/wall_stages_io.h"

#include <algorithm>
#include <set>
#include <string>

#include "server/base/plain_text.h"
#include "server/base/units.h"
#include "server/scene/numbers.h"
#include "server/scene/wall_shapes_io.h"

namespace handrail {
namespace {

std::string of_stage(int i, const std::string& field) {
  return "walls.stage[" + std::to_string(i) + "]." + field;
}

std::string item(const char* list, int k) { return list + ("[" + std::to_string(k) + "]"); }

Problem gone_from(const pb::WallStage& in, int i, const Walls& walls, WallStage& out) {
  for (int k = 0; k < in.without_size(); ++k) {
    const std::string field = of_stage(i, item("without", k));
    const RegionLookup region = find_region(walls, in.without(k));
    if (!region.problem.empty()) return FieldProblem{field, region.problem};
    if (walls.regions[region.index].kind != RegionKind::kWall) {
      return FieldProblem{field, "'" + in.without(k) + "' is not a WALL"};
    }
    out.gone.push_back(region.index);
  }
  return std::nullopt;
}

// Only what is given changes, and only what the region's kind has.
Problem region_from(const pb::WallStage::Region& in, const std::string& path, const Walls& walls,
                    WallStage& out) {
  const RegionLookup found = find_region(walls, in.name());
  if (!found.problem.empty()) return FieldProblem{path + ".name", found.problem};
  if (out.regions.empty()) out.regions = walls.regions;
  WallRegion& region = out.regions[found.index];
  const bool wall = region.kind == RegionKind::kWall;
  const struct {
    const char* field;
    bool given, meant;
    double value;
    double* of;
  } values[] = {{"stiffness_n_mm", in.has_stiffness_n_mm(), wall,
                 in.stiffness_n_mm() * kNewtonPerMm, &region.stiffness},
                {"damping_n_s_mm", in.has_damping_n_s_mm(), wall,
                 in.damping_n_s_mm() * kNewtonPerMm, &region.damping},
                {"viscosity_n_s_m", in.has_viscosity_n_s_m(), !wall, in.viscosity_n_s_m(),
                 &region.viscosity}};
  for (const auto& value : values) {
    if (!value.given) continue;
    if (!value.meant) {
      return FieldProblem{
          path + "." + value.field,
          "has no meaning for '" + in.name() + "', which is " + (wall ? "a WALL" : "no WALL")};
    }
    *value.of = value.value;
  }
  return std::nullopt;
}

struct PlaceLookup {
  std::uint8_t index = 0;
  std::string problem;  // empty: found
};

const EffectSpec* detent_of(const std::vector<EffectSpec>& effects) {
  const auto found = std::find_if(effects.begin(), effects.end(), [](const EffectSpec& e) {
    return e.kind == EffectKind::kDetent;
  });
  return found == effects.end() ? nullptr : &*found;
}

PlaceLookup find_place(const EffectSpec* detent, const std::string& name) {
  if (detent == nullptr) return {0, "no effect is detent {}"};
  const std::vector<std::string>& names = detent->place_names;
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return {static_cast<std::uint8_t>(found - names.begin()), {}};
  const std::string near = nearest_name(name, names);
  return {0, "no place '" + name + "'" + (near.empty() ? "" : "; did you mean '" + near + "'?")};
}

Problem detents_from(const pb::WallStage& in, int i, const EffectSpec* detent, WallStage& out) {
  for (int k = 0; k < in.detent_size(); ++k) {
    const PlaceLookup place = find_place(detent, in.detent(k).place());
    if (!place.problem.empty()) {
      return FieldProblem{of_stage(i, item("detent", k) + ".place"), place.problem};
    }
    if (out.detent_peaks.empty()) {
      out.detent_peaks = detent->peaks;
      out.detent_peaks.resize(detent->places.size(), detent->peak);
    }
    out.detent_peaks[place.index] = in.detent(k).peak_n();
  }
  return std::nullopt;
}

Problem condition_from(const pb::WallStage::When& in, int i, const std::vector<EffectSpec>& effects,
                       const Walls& walls, StageCondition& out) {
  using Leads = StageCondition::Kind;
  const int given = int{in.has_inside()} + int{in.has_turned_over_deg()} +
                    int{in.has_turned_under_deg()} + int{in.has_locked()} + int{in.has_unlocked()};
  if (given != 1) {
    return FieldProblem{of_stage(i, "when"), std::to_string(given) +
                                                 " conditions, expected one of inside, "
                                                 "turned_over_deg, turned_under_deg, locked, "
                                                 "unlocked"};
  }
  if (in.has_inside()) {
    const RegionLookup region = find_region(walls, in.inside());
    if (!region.problem.empty()) return FieldProblem{of_stage(i, "when.inside"), region.problem};
    if (walls.regions[region.index].kind == RegionKind::kWall) {
      return FieldProblem{of_stage(i, "when.inside"), "'" + in.inside() + "' is a WALL"};
    }
    out = {Leads::kInside, region.index, 0.0};
    return std::nullopt;
  }
  if (in.has_locked() || in.has_unlocked()) {
    const PlaceLookup place =
        find_place(detent_of(effects), in.has_locked() ? in.locked() : in.unlocked());
    if (!place.problem.empty()) {
      return FieldProblem{of_stage(i, in.has_locked() ? "when.locked" : "when.unlocked"),
                          place.problem};
    }
    out = {in.has_locked() ? Leads::kLocked : Leads::kUnlocked, place.index, 0.0};
    return std::nullopt;
  }
  const bool over = in.has_turned_over_deg();
  const bool turns = std::any_of(effects.begin(), effects.end(), [](const EffectSpec& e) {
    return e.kind == EffectKind::kProgressive;
  });
  if (!turns) {
    return FieldProblem{of_stage(i, over ? "when.turned_over_deg" : "when.turned_under_deg"),
                        "no effect is progressive {}"};
  }
  out = over ? StageCondition{Leads::kTurnedOver, 0, in.turned_over_deg() * kDeg}
             : StageCondition{Leads::kTurnedUnder, 0, in.turned_under_deg() * kDeg};
  return std::nullopt;
}

}  // namespace

std::optional<FieldProblem> stages_from(const pb::Walls& in, Walls& out) {
  if (in.stage_size() > kMostStages) {
    return FieldProblem{of_stage(kMostStages, "name"), std::to_string(in.stage_size()) +
                                                           " stages, expected at most " +
                                                           std::to_string(kMostStages)};
  }
  std::set<std::string> names;
  for (int i = 0; i < in.stage_size(); ++i) {
    const pb::WallStage& s = in.stage(i);
    if (s.name().empty()) return FieldProblem{of_stage(i, "name"), "is empty"};
    if (!names.insert(s.name()).second) {
      return FieldProblem{of_stage(i, "name"), "a second stage '" + s.name() + "'"};
    }
    WallStage& stage = out.stages.emplace_back();
    stage.name = s.name();
    stage.pose = {plane_vector_of(s.at_mm()) * kMm, s.turn_deg() * kDeg};
    if (Problem p = gone_from(s, i, out, stage)) return p;
    for (int k = 0; k < s.region_size(); ++k) {
      if (Problem p = region_from(s.region(k), of_stage(i, item("region", k)), out, stage)) {
        return p;
      }
    }
  }
  if (out.stages.empty()) out.stages.emplace_back();
  return std::nullopt;
}

std::optional<FieldProblem> stage_effects_from(const pb::Walls& in,
                                               const std::vector<EffectSpec>& effects, Walls& out) {
  for (int i = 0; i < in.stage_size(); ++i) {
    WallStage& stage = out.stages[static_cast<std::size_t>(i)];
    if (Problem p = detents_from(in.stage(i), i, detent_of(effects), stage)) return p;
    if (!in.stage(i).has_when()) continue;
    if (Problem p = condition_from(in.stage(i).when(), i, effects, out, stage.when)) return p;
  }
  return std::nullopt;
}

}  // namespace handrail
