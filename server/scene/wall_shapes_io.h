// Drawn walls as scene files write them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "proto/scene.pb.h"
#include "server/model/walls.h"
#include "server/scene/field_check.h"

namespace handrail {

// A region by name: its index, or what is wrong with the name.
struct RegionLookup {
  std::uint8_t index = 0;
  std::string problem;  // empty: found
};
RegionLookup find_region(const Walls& walls, const std::string& name);

// Shapes, what is around them, and the fillet. `out.regions` must be there.
std::optional<FieldProblem> shapes_from(const pb::Walls& in, Walls& out);

// That the start lies in a shape, and that every shape can be reached from there.
std::optional<FieldProblem> check_shapes(const pb::Walls& in, const Walls& walls);

}  // namespace handrail
