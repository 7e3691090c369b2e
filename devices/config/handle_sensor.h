// The force sensor on a device's handle, as the master's file has it.
#pragma once

#include <memory>
#include <string>

#include "devices/config/device_config_io.h"
#include "devices/hand/sim_handle_sensor.h"
#include "server/base/spatial.h"

namespace handrail {

struct HandleSensor {
  MadeSensor real;                             // one that is there
  std::unique_ptr<SimHandleSensor> simulated;  // or this
  Quat q_HF = Quat::Identity();                // of its axes in the handle's
  Vec3 lever_M = Vec3::Zero();                 // from a stick's pivot to the hand [m]; 0: no stick

  // Null: none is to be used.
  FtSensor* any() const noexcept { return simulated ? simulated.get() : real.any.get(); }
  std::string name() const { return any() != nullptr ? any()->capabilities().name : std::string(); }
  // One that cannot be started is told, as nothing else needs it, and tried again: a card, its
  // library or an address on the network.
  void start(const ComediFtSensor::Say& say) const;
  void stop() const noexcept;
};

// Not yet started.
HandleSensor make_handle_sensor(const pb::MasterConfig& config, const ComediFtSensor::Say& say);

}  // namespace handrail
