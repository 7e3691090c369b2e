// Walls as scene files write them, checked and turned into SI.
#pragma once

#include <optional>
#include <string>

#include "proto/scene.pb.h"
#include "server/model/walls.h"
#include "server/scene/field_check.h"

namespace handrail {

// Checks what ranges cannot say (names, colours, meanings) and converts everything but the painted
// map. Paths in problems are relative to the scene, such as "walls.region[1].colour".
std::optional<FieldProblem> walls_from(const pb::Walls& in, Walls& out);

// Reads the painted map of walls that passed `walls_from`, then checks that the hand can get from
// the start to where it should: drawn or painted. The image is looked for in the folder of
// `scene_file`. May add to `out.warnings`. Takes up to 0.3 s for 4 million pixels.
std::optional<FieldProblem> complete_walls(const pb::Walls& in, const std::string& scene_file,
                                           Walls& out);

}  // namespace handrail
