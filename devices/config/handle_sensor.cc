#include "devices/config/handle_sensor.h"

#include "devices/config/card_options.h"
#include "devices/joystick/joystick_data.h"
#include "server/base/units.h"

namespace handrail {

void HandleSensor::start(const ComediFtSensor::Say& say) const {
  if (any() == nullptr) return;
  if (const Status started = any()->start(); !started) {
    say(true, "force sensor on the handle, handle_sensor: " + started.message() +
                  "; it is tried again, and nothing else needs it");
  }
}

void HandleSensor::stop() const noexcept {
  if (any() != nullptr) any()->stop();
}

HandleSensor make_handle_sensor(const pb::MasterConfig& config, const ComediFtSensor::Say& say) {
  HandleSensor out;
  if (!config.has_handle_sensor()) return out;
  const pb::HandleSensorConfig& c = config.handle_sensor();
  const bool stick = config.device().kind() == pb::DeviceConfig::JOYSTICK ||
                     config.device().kind() == pb::DeviceConfig::SIM_JOYSTICK;
  if (c.has_lever_mm() || stick) {
    out.lever_M.z() = c.has_lever_mm() ? c.lever_mm() * kMm : kJoystickStick;
  }
  if (c.simulated()) {
    out.simulated = std::make_unique<SimHandleSensor>();
    return out;
  }
  out.real = make_sensor(c.sensor(), say, true);
  out.q_HF = mount_of(c.sensor().mount()).X_TF.q;
  return out;
}

}  // namespace handrail
