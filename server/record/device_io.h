// A haptic device's data as a message and back.
#pragma once

#include "devices/haptic_device.h"
#include "proto/record.pb.h"
#include "server/base/status.h"

namespace handrail {

void put(const HapticCapabilities& device, pb::RecordedDevice& out);
Status take(const pb::RecordedDevice& in, HapticCapabilities& out);

}  // namespace handrail
