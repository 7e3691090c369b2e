#include "server/record/device_io.h"

#include <cmath>
#include <string>
#include <utility>

namespace handrail {

namespace {

constexpr int kDynamics = 5;  // mass, damping, friction, resolution, delay

template <typename Field>
void put(const DeviceDynamics& d, Field& out) {
  for (const double v : {d.mass, d.damping, d.friction, d.resolution, d.delay}) out.Add(v);
}

template <typename Field>
void take(const Field& in, DeviceDynamics& out) {
  int next = 0;
  for (double* v : {&out.mass, &out.damping, &out.friction, &out.resolution, &out.delay}) {
    *v = in.Get(next++);
  }
  out.source = "the recording";
}

}  // namespace

void put(const HapticCapabilities& device, pb::RecordedDevice& out) {
  out.set_name(device.name);
  out.set_simulated(device.simulated);
  out.set_senses_rotation(device.senses_rotation);
  out.set_actuates_torque(device.actuates_torque);
  out.set_max_force(device.max_force);
  out.set_continuous_force(device.continuous_force);
  out.set_max_torque(device.max_torque);
  for (int i = 0; i < 3; ++i) out.add_workspace_half(device.workspace_half[i]);
  out.set_buttons(static_cast<std::uint32_t>(device.buttons));
  out.set_velocity_lag(device.velocity_lag);
  out.set_led_by_cursor(device.led_by_cursor);
  out.set_least_mass(device.least_mass);
  put(device.dynamics, *out.mutable_dynamics());
  if (device.actuates_torque) put(device.turning, *out.mutable_turning());
}

Status take(const pb::RecordedDevice& in, HapticCapabilities& out) {
  if (in.workspace_half_size() != 3) {
    return Status::error("device.workspace_half has " + std::to_string(in.workspace_half_size()) +
                         " numbers, expected 3");
  }
  if (in.dynamics_size() != kDynamics) {
    return Status::error("device.dynamics has " + std::to_string(in.dynamics_size()) +
                         " numbers, expected " + std::to_string(kDynamics));
  }
  if (in.turning_size() != 0 && in.turning_size() != kDynamics) {
    return Status::error("device.turning has " + std::to_string(in.turning_size()) +
                         " numbers, expected none or " + std::to_string(kDynamics));
  }
  // A device may make no force.
  for (const auto& [field, value] : {std::pair("max_force", in.max_force()),
                                     std::pair("continuous_force", in.continuous_force())}) {
    if (std::isfinite(value) && value >= 0.0) continue;
    return Status::error(std::string("device.") + field + " is " + std::to_string(value) +
                         ", expected a finite number, at least 0");
  }
  if (!(std::isfinite(in.least_mass()) && in.least_mass() > 0.0)) {
    return Status::error("device.least_mass is " + std::to_string(in.least_mass()) +
                         ", expected a finite number over 0");
  }
  out.name = in.name();
  out.simulated = in.simulated();
  out.senses_rotation = in.senses_rotation();
  out.actuates_torque = in.actuates_torque();
  out.max_force = in.max_force();
  out.continuous_force = in.continuous_force();
  out.max_torque = in.max_torque();
  for (int i = 0; i < 3; ++i) out.workspace_half[i] = in.workspace_half(i);
  out.buttons = static_cast<int>(in.buttons());
  out.velocity_lag = in.velocity_lag();
  out.led_by_cursor = in.led_by_cursor();
  out.least_mass = in.least_mass();
  take(in.dynamics(), out.dynamics);
  if (in.turning_size() == kDynamics) take(in.turning(), out.turning);
  return Status::ok();
}

pb::RecordedArm recorded_arm(Nanos period, bool has_sensor, double sensor_range,
                             const Payload& payload, double force_lag) {
  pb::RecordedArm out;
  out.set_period_ns(period);
  out.set_has_sensor(has_sensor);
  out.set_sensor_range(sensor_range);
  out.set_force_lag(force_lag);
  out.add_payload(payload.mass);
  for (const Vec3& v : {payload.centre_T, payload.bias_T.force, payload.bias_T.torque}) {
    for (int i = 0; i < 3; ++i) out.add_payload(v[i]);
  }
  return out;
}

}  // namespace handrail
