#include "server/lab/stability/bench_device.h"

#include <cmath>

#include "devices/joystick/joystick_data.h"
#include "devices/omni/omni_data.h"

namespace handrail {
namespace {

constexpr double kLeanShare = 0.5;  // of the sustained force, chosen

// The passive part of a simulated hand.
PassiveGrip passive(const HandOptions& hand) {
  return {hand.mass, 2.0 * hand.damping_ratio * std::sqrt(hand.stiffness * hand.mass),
          hand.stiffness, Vec2::Zero()};
}

BenchDevice omni() {
  BenchDevice out;
  out.name = "omni";
  out.capabilities = omni_capabilities(false);
  out.cutoff = 30.0;  // as the simulated one
  out.damping = 5.0;  // what CHAI3D holds for the most on it
  out.light = stylus_grip(kLightest);
  out.firm = stylus_grip(kFirmest);
  return out;
}

BenchDevice joystick() {
  BenchDevice out;
  out.name = "joystick";
  out.capabilities = joystick_capabilities();
  out.cutoff = kJoystickVelocityCutoff;
  out.damping = 20.0;  // chosen
  out.light = passive(joystick_grip(0.0));
  out.firm = passive(joystick_grip(1.0));
  return out;
}

// Chosen: light, smooth and seen as it is, so that nothing but its damping takes energy.
BenchDevice linear() {
  BenchDevice out;
  out.name = "linear";
  HapticCapabilities& c = out.capabilities;
  c.name = "linear axis";
  c.max_force = c.continuous_force = 10.0;
  c.dynamics = {.mass = 0.1, .damping = 0.5, .resolution = kFinest, .source = "chosen"};
  c.least_mass = 0.1;
  out.damping = 5.0;
  out.light = stylus_grip(kLightest);
  out.firm = stylus_grip(kFirmest);
  return out;
}

}  // namespace

PassiveGrip stylus_grip(double stiffness) {
  HandOptions hand;
  hand.stiffness = stiffness;
  return passive(hand);
}

DeviceBody BenchDevice::body() const {
  const DeviceDynamics& of = capabilities.dynamics;
  return {of.mass, of.damping, of.friction};
}

PassiveGrip BenchDevice::grip(GripKind kind) const {
  return kind == GripKind::kNone ? PassiveGrip{} : kind == GripKind::kLight ? light : firm;
}

const char* name_of(GripKind kind) {
  return kind == GripKind::kNone ? "none" : kind == GripKind::kLight ? "light" : "firm";
}

const std::array<BenchDevice, 3>& bench_devices() {
  static const std::array<BenchDevice, 3> devices = [] {
    std::array<BenchDevice, 3> out = {omni(), joystick(), linear()};
    for (BenchDevice& one : out) one.lean = kLeanShare * one.capabilities.continuous_force;
    out[2].lean = 1.0;  // it need not sustain what it may
    return out;
  }();
  return devices;
}

}  // namespace handrail
