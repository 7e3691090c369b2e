#include "server/painting/map_detent.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>

#include "server/base/plain_text.h"
#include "server/base/units.h"
#include "server/painting/map_fill.h"
#include "server/painting/map_reach.h"

namespace handrail {
namespace {

using Problem = std::optional<FieldProblem>;

constexpr double kLeastRadius = 0.2 * kMm, kMostRadius = 100.0 * kMm;  // as scene.proto has them

// Adding 0 makes -0 a 0.
std::string mm_text(double metres) {
  return number_text(std::round(metres / kMm * 100.0) / 100.0 + 0.0);
}
std::string point_text(const Vec2& p) { return mm_text(p.x()) + ", " + mm_text(p.y()) + " mm"; }

// Adds one place; says what is wrong with it.
std::string add_place(const std::string& name, const Vec2& at, double radius, double peak,
                      EffectSpec& out) {
  const std::string what = "the patch '" + name + "' at " + point_text(at);
  if (radius < kLeastRadius || radius > kMostRadius) {
    return what + " is as large as a disc of radius " + mm_text(radius) + " mm, expected " +
           mm_text(kLeastRadius) + " to " + mm_text(kMostRadius) + " mm, or radius_mm";
  }
  for (std::size_t i = 0; i < out.places.size(); ++i) {
    const double apart = (at - out.places[i]).norm();
    if (apart >= radius + out.radii[i]) continue;
    return what + " is " + mm_text(apart) + " mm from '" + out.place_names[i] +
           "', expected at least both radii, " + mm_text(radius) + " and " + mm_text(out.radii[i]) +
           " mm";
  }
  out.places.push_back(at);
  out.place_names.push_back(name);
  out.radii.push_back(radius);
  out.peaks.push_back(peak);
  return {};
}

// The region's patches, each a place of its own name.
Problem paint_region(const std::string& path, const WallRegion& region,
                     const std::vector<MapPatch>& patches, Walls& walls, EffectSpec& out) {
  const CoverageMap& map = *walls.map;
  if (out.places.size() + patches.size() > kMostDetents) {
    return FieldProblem{path, std::to_string(out.places.size() + patches.size()) +
                                  " places in all, " + std::to_string(patches.size()) +
                                  " of them patches of '" + region.name + "', expected at most " +
                                  std::to_string(kMostDetents)};
  }
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const MapPatch& patch = patches[i];
    const double area = static_cast<double>(patch.pixels) * map.pixel * map.pixel;
    const double radius =
        region.detent->radius > 0.0 ? region.detent->radius : std::sqrt(area / std::numbers::pi);
    const std::string name =
        patches.size() == 1 ? region.name : region.name + " " + std::to_string(i + 1);
    const double peak = region.detent->peak > 0.0 ? region.detent->peak : out.peak;
    std::string wrong = add_place(name, patch.centre, radius, peak, out);
    if (!wrong.empty()) return FieldProblem{path, std::move(wrong)};
    const std::optional<std::size_t> middle = pixel_of(map, patch.centre);
    if (middle && is_open(map, *middle, 0)) continue;
    walls.warnings.push_back(path + ": the middle of the patch '" + name + "', " +
                             point_text(patch.centre) +
                             ", is in a wall: the hand is pulled against it");
  }
  return std::nullopt;
}

}  // namespace

std::vector<MapPatch> patches_of(const CoverageMap& map, std::uint8_t region) {
  std::vector<std::uint8_t> in(map.region.size());
  for (std::size_t i = 0; i < in.size(); ++i) in[i] = map.region[i] == region ? 1 : 0;
  MapFiller filler(map, std::move(in));
  std::vector<MapPatch> out;
  for (std::size_t i = 0; i < map.region.size(); ++i) {
    if (!filler.has(i)) continue;
    MapPatch& patch = out.emplace_back();
    filler.take(i, [&](std::size_t first, std::size_t end) {
      const auto count = static_cast<double>(end - first);
      patch.pixels += end - first;
      patch.centre += 0.5 * count * (centre_of(map, first) + centre_of(map, end - 1));
    });
    patch.centre /= static_cast<double>(patch.pixels);
  }
  return out;
}

std::optional<FieldProblem> paint_detents(Walls& walls, std::vector<EffectSpec>& effects) {
  const auto detent = std::find_if(effects.begin(), effects.end(), [](const EffectSpec& e) {
    return e.kind == EffectKind::kDetent;
  });
  for (std::size_t r = 0; r < walls.regions.size(); ++r) {
    const WallRegion region = walls.regions[r];
    if (!region.detent) continue;
    const std::string path = "walls.region[" + std::to_string(r) + "].detent";
    if (detent == effects.end()) {
      walls.warnings.push_back(path + ": not simulated, as no effect is detent {}");
      continue;
    }
    detent->radii.resize(detent->places.size(), detent->radius);
    detent->peaks.resize(detent->places.size(), detent->peak);
    const auto patches = patches_of(*walls.map, static_cast<std::uint8_t>(r));
    if (Problem p = paint_region(path, region, patches, walls, *detent)) return p;
  }
  return std::nullopt;
}

}  // namespace handrail
