// The stages of a scene's walls.
#pragma once

#include <optional>
#include <vector>

#include "proto/scene.pb.h"
#include "server/model/effect_list.h"
#include "server/model/walls.h"
#include "server/scene/field_check.h"

namespace handrail {

// Names, poses, and how the regions are in each stage. `out.regions` must be there. A problem where
// a name is missing, used twice or unknown, or a value has no meaning for its region.
std::optional<FieldProblem> stages_from(const pb::Walls& in, Walls& out);

// What of the stages asks for effects: detents, and conditions. `out` has its stages, `effects`
// their places. A problem where no such effect, region or place is listed.
std::optional<FieldProblem> stage_effects_from(const pb::Walls& in,
                                               const std::vector<EffectSpec>& effects, Walls& out);

}  // namespace handrail
