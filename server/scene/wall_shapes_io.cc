#include "server/scene/wall_shapes_io.h"

#include <algorithm>
#include <numbers>
#include <vector>

#include "server/base/plain_text.h"
#include "server/base/units.h"
#include "server/scene/field_check.h"
#include "server/scene/numbers.h"
#include "server/scene/shape_reach.h"

namespace handrail {
namespace {

constexpr int kMostShapes = 256;

Vec2 metres(const Numbers& v) { return Vec2(v[0], v[1]) * kMm; }

std::string shape_path(int i) { return "walls.shape[" + std::to_string(i) + "]"; }

// Fills in `out`; returns the name of the shape's block and sets `region` to its region's name.
std::string geometry_from(const pb::WallShape& in, WallShape& out, std::string& region) {
  if (in.has_rectangle()) {
    out.kind = WallShape::Kind::kRectangle;
    out.centre = metres(in.rectangle().centre_mm());
    out.half = metres(in.rectangle().size_mm()) / 2.0;
    out.angle = in.rectangle().angle_deg() * kDeg;
    region = in.rectangle().region();
    return "rectangle";
  }
  if (in.has_disc()) {
    out.kind = WallShape::Kind::kDisc;
    out.centre = metres(in.disc().centre_mm());
    out.radius = in.disc().radius_mm() * kMm;
    region = in.disc().region();
    return "disc";
  }
  out.kind = WallShape::Kind::kArc;
  out.centre = metres(in.arc().centre_mm());
  out.radius = in.arc().radius_mm() * kMm;
  out.width = in.arc().width_mm() * kMm;
  out.from = in.arc().from_deg() * kDeg;
  out.to = in.arc().to_deg() * kDeg;
  region = in.arc().region();
  return "arc";
}

Problem check_arc(const pb::WallShape::Arc& arc, const std::string& path) {
  if (arc.width_mm() > 2.0 * arc.radius_mm()) {
    return FieldProblem{path + ".width_mm", number_text(arc.width_mm()) +
                                                " mm is more than twice the radius of " +
                                                number_text(arc.radius_mm()) + " mm"};
  }
  const double turn = arc.to_deg() - arc.from_deg();
  if (turn > 0.0 && turn <= 360.0) return std::nullopt;
  return FieldProblem{path + ".to_deg", number_text(arc.to_deg()) + " deg is " + number_text(turn) +
                                            " deg from from_deg, expected above 0 to 360"};
}

Problem shape_from(const pb::WallShape& in, int i, Walls& out) {
  const std::string path = shape_path(i);
  if (in.has_rectangle() + in.has_disc() + in.has_arc() != 1) {
    return FieldProblem{path, "expected exactly one of rectangle, disc and arc"};
  }
  std::string region;
  const std::string block = path + "." + geometry_from(in, out.shapes.emplace_back(), region);
  const RegionLookup found = find_region(out, region);
  if (!found.problem.empty()) return FieldProblem{block + ".region", found.problem};
  if (out.regions[found.index].kind == RegionKind::kWall) {
    return FieldProblem{block + ".region", "'" + region + "' is a WALL, but shapes are free space"};
  }
  out.shapes.back().region = found.index;
  return in.has_arc() ? check_arc(in.arc(), block) : std::nullopt;
}

Problem outside_from(const pb::Walls& in, Walls& out) {
  std::vector<std::uint8_t> walls;
  for (std::size_t i = 0; i < out.regions.size(); ++i) {
    if (out.regions[i].kind == RegionKind::kWall) walls.push_back(static_cast<std::uint8_t>(i));
  }
  if (in.has_outside()) {
    const RegionLookup found = find_region(out, in.outside());
    if (!found.problem.empty()) return FieldProblem{"walls.outside", found.problem};
    if (out.regions[found.index].kind != RegionKind::kWall) {
      return FieldProblem{"walls.outside", "'" + in.outside() + "' is not a WALL"};
    }
    out.outside = found.index;
    return std::nullopt;
  }
  if (walls.empty()) return FieldProblem{"walls", "has no region of kind: WALL"};
  if (walls.size() > 1 && in.shape_size() > 0) {
    return FieldProblem{"walls.outside", "missing, but there are several WALL regions"};
  }
  out.outside = walls.front();
  return std::nullopt;
}

}  // namespace

RegionLookup find_region(const Walls& walls, const std::string& name) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < walls.regions.size(); ++i) {
    if (walls.regions[i].name == name) return {static_cast<std::uint8_t>(i), {}};
    names.push_back(walls.regions[i].name);
  }
  const std::string near = nearest_name(name, names);
  return {0, "no region '" + name + "'" + (near.empty() ? "" : "; did you mean '" + near + "'?")};
}

Problem shapes_from(const pb::Walls& in, Walls& out) {
  if (in.shape_size() > kMostShapes) {
    return FieldProblem{shape_path(kMostShapes), std::to_string(in.shape_size()) +
                                                     " shapes, expected at most " +
                                                     std::to_string(kMostShapes)};
  }
  for (int i = 0; i < in.shape_size(); ++i) {
    if (Problem p = shape_from(in.shape(i), i, out)) return p;
  }
  if (in.has_image()) {
    const char* misplaced = in.has_outside() ? "outside" : in.has_fillet_mm() ? "fillet_mm" : "";
    if (*misplaced != '\0') {
      return FieldProblem{std::string("walls.") + misplaced, "only used with shapes"};
    }
  }
  out.fillet = in.fillet_mm() * kMm;
  return outside_from(in, out);
}

Problem check_shapes(const pb::Walls& in, const Walls& walls) {
  const std::vector<bool> reached = shapes_reached(walls.shapes, walls.start);
  const auto first = std::find(reached.begin(), reached.end(), false);
  if (first == reached.end()) return std::nullopt;
  if (std::find(reached.begin(), reached.end(), true) == reached.end()) {
    const std::string place =
        number_text(walls.start.x() / kMm) + ", " + number_text(walls.start.y() / kMm) + " mm";
    return FieldProblem{in.start_mm_size() > 0 ? "walls.start_mm" : "walls",
                        "the start " + place + " is inside the wall, expected it in a shape"};
  }
  return FieldProblem{shape_path(static_cast<int>(first - reached.begin())),
                      "cannot be reached from the start, the wall seals it off"};
}

}  // namespace handrail
