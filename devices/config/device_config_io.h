// What a daemon's file says of devices, as their drivers take it.
#pragma once

#include <memory>
#include <optional>

#include "devices/comedi/comedi_ft_sensor.h"
#include "devices/comedi/ft_source.h"
#include "devices/evdev/stop_switch.h"
#include "devices/melfa/melfa_robot.h"
#include "devices/net_ft/net_ft_sensor.h"
#include "devices/registry.h"
#include "proto/config.pb.h"

namespace handrail {

// All of a configuration that was loaded, and so checked (server/scene/config_io.h).
HapticDeviceOptions haptic_options(const pb::DeviceConfig& config);
MelfaOptions robot_options(const pb::RobotConfig& config);
NetFtOptions sensor_options(const pb::FtConfig& config);
ComediFtOptions comedi_sensor_options(const pb::FtConfig& config);

// A force sensor, the arm's or the handle's.
struct MadeSensor {
  std::unique_ptr<FtSensor> any;  // null: none is to be used
  NetFtSensor* net = nullptr;     // the same, where it is on the network
};
// Not yet started. `say`: told what becomes of a sensor at a card, as ComediFtSensor has it.
// `waits`: as ComediFtOptions and NetFtOptions have it.
MadeSensor make_sensor(const pb::FtConfig& config, ComediFtSensor::Say say, bool waits = false);

// None: no switch is configured.
std::optional<StopSwitchOptions> switch_options(const pb::SlaveConfig& config);

}  // namespace handrail
