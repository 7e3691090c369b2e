// From the rig's configuration file to its options.
#pragma once

#include <vector>

#include "devices/rig/rig.h"
#include "server/base/status.h"
#include "server/scene/overrides.h"

namespace handrail {

namespace pb {
class RigConfig;
}

// SI options of a configuration whose fields are within their ranges. The arm's noise, the sensor's
// noise and the switch each get a seed of their own from the one configured. An error names the
// field and value that the arm cannot have: a start outside the joint ranges, a list that is not
// six long, a scene that is not there or not valid.
Result<RigOptions> rig_options(const pb::RigConfig& config);

// The same for the default configuration with overrides set in it, whose keys are "rig." and a
// field's name, such as "rig.servo_lag_ms".
Result<RigOptions> rig_options(const std::vector<Override>& overrides);

}  // namespace handrail
