// The limits section of a scene file.
#pragma once

#include <optional>

#include "proto/scene.pb.h"
#include "server/model/scene.h"
#include "server/scene/field_check.h"

namespace handrail {

// Converts `in` to SI; the problem names a range that leaves Table 3.1 or is empty.
std::optional<FieldProblem> limits_from(const pb::Limits& in, Scene::Limits& out);

}  // namespace handrail
