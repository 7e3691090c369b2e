// The limits section of a scene file.
#pragma once

#include <optional>

#include "proto/scene.pb.h"
#include "server/scene/field_check.h"
#include "server/scene/scene.h"

namespace handrail {

// Table 3.1 of the dissertation, the widest limits a scene may ask for: ranges, speeds, and
// accelerations that reach top speed in 0.15 s. SI. The arm's kinematics hold the same numbers; a
// test compares them.
JointLimits arm_table_limits();

// Converts `in` to SI; the problem names a range that leaves Table 3.1 or is empty.
std::optional<FieldProblem> limits_from(const pb::Limits& in, Scene::Limits& out);

}  // namespace handrail
