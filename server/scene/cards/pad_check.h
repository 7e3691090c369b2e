// Gamepads and force-feedback joysticks, as they are configured: what a field's own range does not
// say.
#pragma once

#include <optional>

#include "proto/config.pb.h"
#include "server/model/field_problem.h"

namespace handrail {

std::optional<FieldProblem> check_pads(const pb::DeviceConfig& config);

}  // namespace handrail
