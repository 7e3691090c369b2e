// From the rig's configuration file to its options.
#pragma once

#include "devices/rig/rig.h"
#include "server/base/status.h"

namespace handrail {

namespace pb {
class RigConfig;
}

// SI options of a configuration whose fields are within their ranges. The arm's noise, the sensor's
// noise and the switch each get a seed of their own from the one configured. An error names the
// field and value that the arm cannot have: a start outside the joint ranges, a list that is not
// six long.
Result<RigOptions> rig_options(const pb::RigConfig& config);

}  // namespace handrail
