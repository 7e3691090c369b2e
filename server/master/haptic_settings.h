// What a scene and a device mean for the master's step.
#pragma once

#include "devices/haptic_device.h"
#include "proto/config.pb.h"
#include "server/haptic/haptic_step.h"
#include "server/model/scene.h"

namespace handrail {

// `governor`: what the device cannot hold is rendered less stiff, and no energy is made.
HapticSettings haptic_settings(const Scene& scene, const HapticCapabilities& device,
                               bool governor = false);

// What proves that somebody is there, as the configuration wants it or else as the device lets.
Presence presence_of(const pb::MasterConfig& config, const HapticCapabilities& device);

Nanos nanos_of_ms(double value);

// The device's reading as the step takes it.
HandReading hand_reading(const HapticSample& sample) noexcept;

}  // namespace handrail
