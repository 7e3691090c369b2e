// What is known of a haptic device or an arm, as a message.
#pragma once

#include "devices/haptic_device.h"
#include "proto/record.pb.h"
#include "server/base/status.h"
#include "server/base/time.h"
#include "server/model/payload.h"

namespace handrail {

void put(const HapticCapabilities& device, pb::RecordedDevice& out);
Status take(const pb::RecordedDevice& in, HapticCapabilities& out);

// What a slave knows besides the scene, as follow_settings takes it.
pb::RecordedArm recorded_arm(Nanos period, bool has_sensor, double sensor_range,
                             const Payload& payload = {}, double force_lag = 0.0);

}  // namespace handrail
