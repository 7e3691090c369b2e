// Tools as scenes and operators write them, turned into calls. One validator for both.
#pragma once

#include <optional>

#include "proto/scene.pb.h"
#include "server/model/tool_call.h"
#include "server/scene/field_check.h"

namespace handrail {

// Checks every field (range, count, finite, meaningful for the kind) and the geometry, and converts
// to SI in `call`. On a problem `call` is left alone; the path is relative to the tool, such as
// "end_mm".
std::optional<FieldProblem> tool_call_from(const pb::Tool& tool, ToolCall& call);

}  // namespace handrail
