// The rig's effects of a scene file, turned into data.
#pragma once

#include <optional>

#include "proto/simulate.pb.h"
#include "server/model/simulate.h"
#include "server/scene/field_check.h"

namespace handrail {

// Converts the list to SI in `out`, whose fields' ranges have been checked. Each entry must hold
// exactly one effect; only planes, boxes and cylinders may come again, at most kMostTouched things
// to touch in all; directions are no zero vectors, a key fits its socket, which is hard and
// whose bottom lies below chamfer and guide; a thread has a socket. Paths begin with
// "simulate.effect[i]".
std::optional<FieldProblem> simulate_from(const pb::Simulate& in, Simulate& out);

}  // namespace handrail
