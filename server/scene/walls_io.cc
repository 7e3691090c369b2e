#include "server/scene/walls_io.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <vector>

#include "server/base/plain_text.h"
#include "server/base/units.h"
#include "server/painting/colour.h"
#include "server/painting/coverage.h"
#include "server/painting/coverage_check.h"
#include "server/painting/png_io.h"
#include "server/scene/field_check.h"
#include "server/scene/numbers.h"
#include "server/scene/wall_shapes_io.h"
#include "server/scene/wall_stages_io.h"

namespace handrail {
namespace {

constexpr int kMostRegions = 64;
constexpr double kSquare = 1e-3;  // pixels may be this share off square

std::string at(const char* list, int i, const char* field) {
  return std::string("walls.") + list + "[" + std::to_string(i) + "]." + field;
}

RegionKind kind_of(pb::WallRegion::Kind kind) {
  switch (kind) {
    case pb::WallRegion::FREE: return RegionKind::kFree;
    case pb::WallRegion::WALL: return RegionKind::kWall;
    case pb::WallRegion::AISLE: return RegionKind::kAisle;
  }
  return RegionKind::kFree;
}

// A value the kind would ignore is more likely a mistake than a wish.
Problem check_meaning(const pb::WallRegion& r, int i) {
  const bool wall = r.kind() == pb::WallRegion::WALL, aisle = r.kind() == pb::WallRegion::AISLE;
  const struct {
    const char* field;
    bool given;
    bool meant;
  } uses[] = {{"stiffness_n_mm", r.has_stiffness_n_mm(), wall},
              {"damping_n_s_mm", r.has_damping_n_s_mm(), wall},
              {"viscosity_n_s_m", r.has_viscosity_n_s_m(), !wall},
              {"one_way", r.one_way_size() > 0, aisle},
              {"progressive", r.progressive(), aisle},
              {"detent", r.has_detent(), !wall}};
  for (const auto& use : uses) {
    if (!use.given || use.meant) continue;
    return FieldProblem{at("region", i, use.field),
                        "has no meaning for " + pb::WallRegion::Kind_Name(r.kind())};
  }
  return std::nullopt;
}

Problem colour_from(const pb::Walls& in, int i, Walls& out) {
  const std::string& text = in.region(i).colour();
  const auto field = [&] { return at("region", i, "colour"); };
  if (text.empty()) {
    if (!in.has_image()) return std::nullopt;
    return FieldProblem{field(), "missing, but a painted map needs a colour for every region"};
  }
  const std::optional<Rgb> rgb = colour_of(text);
  if (!rgb) return FieldProblem{field(), "'" + text + "', expected \"#rrggbb\" or \"transparent\""};
  for (int k = 0; k < i; ++k) {
    const std::string& other = in.region(k).colour();
    if (other.empty() || is_transparent(other) != is_transparent(text)) continue;
    if (!is_transparent(text) && colour_of(other) != rgb) continue;
    return FieldProblem{field(), "'" + text + "' is the colour of '" + in.region(k).name() +
                                     "' already, expected each colour once"};
  }
  out.regions[static_cast<std::size_t>(i)].rgb = *rgb;
  return std::nullopt;
}

Problem region_from(const pb::Walls& in, int i, Walls& out) {
  const pb::WallRegion& r = in.region(i);
  if (r.name().empty()) return FieldProblem{at("region", i, "name"), "is empty"};
  for (const WallRegion& other : out.regions) {
    if (other.name != r.name()) continue;
    return FieldProblem{at("region", i, "name"), "a second region '" + r.name() + "'"};
  }
  if (Problem p = check_meaning(r, i)) return p;
  WallRegion& region = out.regions.emplace_back();
  region.name = r.name();
  region.kind = kind_of(r.kind());
  region.stiffness = r.stiffness_n_mm() * kNewtonPerMm;
  region.damping = r.damping_n_s_mm() * kNewtonPerMm;
  region.viscosity = r.viscosity_n_s_m();
  region.progressive = r.progressive();
  if (r.one_way_size() > 0) {
    const Vec2 way = plane_vector_of(r.one_way());
    if (way.norm() < 1e-9) return FieldProblem{at("region", i, "one_way"), "has no direction"};
    region.one_way = way.normalized();
  }
  if (r.has_detent()) {
    if (!in.has_image()) {
      return FieldProblem{at("region", i, "detent"),
                          "only used with an image; effect { detent } takes places as well"};
    }
    region.detent = {r.detent().radius_mm() * kMm, r.detent().peak_n()};
  }
  return colour_from(in, i, out);
}

Problem regions_from(const pb::Walls& in, Walls& out) {
  if (in.region_size() == 0) return FieldProblem{"walls", "has no region, expected at least one"};
  if (in.region_size() > kMostRegions) {
    return FieldProblem{at("region", kMostRegions, "name"), std::to_string(in.region_size()) +
                                                                " regions, expected at most " +
                                                                std::to_string(kMostRegions)};
  }
  for (int i = 0; i < in.region_size(); ++i) {
    if (Problem p = region_from(in, i, out)) return p;
  }
  return std::nullopt;
}

Problem method_from(const pb::Walls& in, Walls& out) {
  const bool image = in.has_image(), shapes = in.shape_size() > 0;
  if (image == shapes) {
    return FieldProblem{"walls", image ? "has both image and shapes, expected one of them"
                                       : "has neither image nor shape, expected one of them"};
  }
  const auto method = in.has_method() ? in.method()
                      : image         ? pb::Walls::SUBPIXEL
                                      : pb::Walls::EXACT;
  if ((method == pb::Walls::EXACT) == image) {
    return FieldProblem{"walls.method", pb::Walls::Method_Name(method) +
                                            (image ? " needs shapes, not an image"
                                                   : " needs an image; shapes are felt EXACT")};
  }
  if (in.has_search_radius_px() && method != pb::Walls::PUBLISHED) {
    return FieldProblem{"walls.search_radius_px", "only used with method: PUBLISHED"};
  }
  out.method = method == pb::Walls::EXACT      ? WallMethod::kExact
               : method == pb::Walls::SUBPIXEL ? WallMethod::kSubpixel
                                               : WallMethod::kPublished;
  out.search_radius = in.search_radius_px();
  return std::nullopt;
}

int transparent_of(const pb::Walls& in) {
  for (int i = 0; i < in.region_size(); ++i) {
    if (is_transparent(in.region(i).colour())) return i;
  }
  return -1;
}

// The law of the scene, or a guess and a warning that says it.
EdgeLaw law_of(const pb::Walls& in, const RgbaImage& image, CoverageRules rules, Walls& out) {
  if (in.image().has_edges()) {
    return in.image().edges() == pb::WallImage::SRGB     ? EdgeLaw::kSrgb
           : in.image().edges() == pb::WallImage::LINEAR ? EdgeLaw::kLinear
                                                         : EdgeLaw::kAlpha;
  }
  const EdgeGuess guess = guess_edges(image, rules);
  const char* name = guess.law == EdgeLaw::kSrgb     ? "SRGB"
                     : guess.law == EdgeLaw::kLinear ? "LINEAR"
                                                     : "ALPHA";
  out.warnings.push_back(std::string("walls.image.edges: not given, guessed ") + name + ", " +
                         guess.why);
  return guess.law;
}

Problem map_from(const pb::Walls& in, const std::string& scene_file, Walls& out) {
  const auto file = std::filesystem::path(scene_file).parent_path() / in.image().file();
  const auto problem = [&](const std::string& what) {
    return FieldProblem{"walls.image.file", file.string() + ": " + what};
  };
  Result<RgbaImage> image = read_png(file.string());
  if (!image) return FieldProblem{"walls.image.file", image.message()};
  const double w = in.image().size_mm(0) / image->width, h = in.image().size_mm(1) / image->height;
  if (std::abs(w - h) > kSquare * h) {
    return FieldProblem{"walls.image.size_mm", number_text(in.image().size_mm(0)) + " x " +
                                                   number_text(in.image().size_mm(1)) + " mm on " +
                                                   std::to_string(image->width) + " x " +
                                                   std::to_string(image->height) +
                                                   " pixels, expected square pixels"};
  }
  CoverageRules rules;
  for (const WallRegion& region : out.regions) {
    rules.palette.push_back({region.rgb, region.kind == RegionKind::kWall, region.name});
  }
  rules.transparent = transparent_of(in);
  rules.law = law_of(in, *image, rules, out);
  if (rules.law == EdgeLaw::kAlpha && rules.transparent < 0) {
    return FieldProblem{"walls.image.edges", "ALPHA needs a region with colour \"transparent\""};
  }
  std::vector<std::string> warnings;
  Result<CoverageMap> map = coverage_of(*image, rules, warnings);
  if (!map) return problem(map.message());
  for (const std::string& warning : warnings) {
    out.warnings.push_back("walls.image.file: " + warning);
  }
  map->pixel = w * kMm;
  out.image = file.string();
  out.map = std::make_shared<const CoverageMap>(std::move(*map));
  return std::nullopt;
}

// Most likely a typing mistake in the scene, or a layer that was not exported.
void warn_of_unused_colours(const pb::Walls& in, Walls& out) {
  std::array<bool, kMostRegions> used{};
  const CoverageMap& map = *out.map;
  for (std::size_t i = 0; i < map.open.size(); ++i) {
    used[map.region[i]] = true;
    if (map.open[i] != 65535) used[map.wall[i]] = true;
  }
  for (int i = 0; i < in.region_size(); ++i) {
    if (used[static_cast<std::size_t>(i)]) continue;
    out.warnings.push_back(at("region", i, "colour") + ": '" + in.region(i).colour() +
                           "' paints nothing, so there is no '" + in.region(i).name() + "'");
  }
}

Problem check_way(const pb::Walls& in, Walls& out) {
  const MapCheck check = check_map(out);
  for (const std::string& warning : check.warnings) out.warnings.push_back("walls: " + warning);
  if (check.problem.empty()) return std::nullopt;
  return FieldProblem{in.start_mm_size() > 0 ? "walls.start_mm" : "walls", check.problem};
}

}  // namespace

std::optional<FieldProblem> walls_from(const pb::Walls& in, Walls& out) {
  if (Problem p = method_from(in, out)) return p;
  if (Problem p = regions_from(in, out)) return p;
  if (Problem p = shapes_from(in, out)) return p;
  out.start = plane_vector_of(in.start_mm()) * kMm;
  return stages_from(in, out);
}

std::optional<FieldProblem> complete_walls(const pb::Walls& in, const std::string& scene_file,
                                           Walls& out) {
  if (in.has_image()) {
    if (Problem p = map_from(in, scene_file, out)) return p;
    warn_of_unused_colours(in, out);
    return check_way(in, out);
  }
  return check_shapes(in, out);
}

}  // namespace handrail
