// The effects of a scene file, turned into data.
#pragma once

#include <optional>
#include <vector>

#include "proto/effect.pb.h"
#include "server/model/effect_list.h"
#include "server/scene/field_check.h"

namespace handrail {

// Converts the list to SI in `out`, whose fields' ranges have been checked. Each entry must hold
// exactly one effect, each kind at most once; places of a detent lie apart, and there are some
// unless its places are `painted`, too. Paths begin with "effect[i]". Empty lists are no error:
// nothing is simulated.
std::optional<FieldProblem> effects_from(
    const google::protobuf::RepeatedPtrField<pb::Effect>& effects, std::vector<EffectSpec>& out,
    bool painted = false);

}  // namespace handrail
