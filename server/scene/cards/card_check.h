// Devices at a card that comedi drives, as they are configured: what a field's own range does not
// say.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "proto/config.pb.h"
#include "server/model/field_problem.h"

namespace handrail {

std::optional<FieldProblem> check_joystick(const pb::DeviceConfig& config);
// The blocks `comedi` and `mount` of the field `sensor`.
std::optional<FieldProblem> check_comedi_sensor(const pb::FtConfig& config,
                                                const std::string& sensor);

// Libraries whose name is a path, from the folder of `file` on. Without a slash it is a name for
// the loader.
void resolve_libraries(const std::string& file, pb::DeviceConfig& config);
void resolve_libraries(const std::string& file, pb::FtConfig& config);

}  // namespace handrail
