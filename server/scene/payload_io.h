// The payload of a slave's configuration.
#pragma once

#include <string>

#include "proto/config.pb.h"
#include "server/model/payload.h"

namespace handrail {

// `in` has passed the configuration's checks.
Payload payload_from(const pb::PayloadConfig& in);
pb::PayloadConfig payload_config(const Payload& payload);

// The same as the block of a slave's file, rounded to 0.1 g, 10 um, 1 mN and 10 uN m.
std::string payload_text(const Payload& payload);

}  // namespace handrail
