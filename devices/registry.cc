#include "devices/registry.h"

#include <cmath>
#include <utility>

#include "devices/hand/recorded_hand_io.h"
#include "devices/joystick/sim_joystick.h"
#include "devices/omni/recorded_device.h"
#include "devices/omni/sim_omni.h"
#include "devices/page/page_data.h"
#include "devices/page/page_device.h"

namespace handrail {
namespace {

using Made = Result<std::unique_ptr<HapticDevice>>;

Status check(const HandOptions& o) {
  struct Field {
    const char* name;
    double value;
    bool may_be_zero;
  };
  const Field fields[] = {
      {"mass", o.mass, false},
      {"stiffness", o.stiffness, false},
      {"damping_ratio", o.damping_ratio, true},
      {"tremor_rms", o.tremor_rms, true},
      {"drift_rms", o.drift_rms, true},
      {"drift_rotation_rms", o.drift_rotation_rms, true},
      {"reaction", o.reaction, true},
      {"rotation_inertia", o.rotation_inertia, false},
      {"rotation_stiffness", o.rotation_stiffness, false},
      {"rotation_damping_ratio", o.rotation_damping_ratio, true},
  };
  for (const Field& f : fields) {
    if (std::isfinite(f.value) && (f.value > 0.0 || (f.may_be_zero && f.value == 0.0))) continue;
    return Status::error(std::string("hand: ") + f.name + " is " + std::to_string(f.value) +
                         ", expected a finite number " + (f.may_be_zero ? ">= 0" : "> 0"));
  }
  return Status::ok();
}

Made sim_omni(const HandOptions& hand, bool torque) {
  if (Status status = check(hand); !status) return status;
  return Made(std::make_unique<SimOmni>(hand, torque));
}

Made recorded(const HapticDeviceOptions& options) {
  if (options.recording_path.empty()) {
    return Status::error("recording is \"\", expected the path of a CSV file");
  }
  auto motion = load_recorded_motion(options.recording_path);
  if (!motion) return motion.status();
  return Made(std::make_unique<RecordedDevice>(std::move(*motion)));
}

Made sim_joystick(const HapticDeviceOptions& o) {
  if (Status status = check(o.hand); !status) return status;
  if (o.recording_path.empty()) return Made(std::make_unique<SimJoystick>(o.hand, o.effects));
  auto motion = load_recorded_motion(o.recording_path);
  if (!motion) return motion.status();
  return Made(std::make_unique<SimJoystick>(o.hand, o.effects, std::move(*motion)));
}

Made page(const HapticDeviceOptions& o) {
  if (Status status = check(o.hand); !status) return status;
  return Made(std::make_unique<PageDevice>(o.hand));
}

EvdevKernel& kernel_of(const HapticDeviceOptions& o) {
  return o.evdev != nullptr ? *o.evdev : evdev_kernel();
}

struct Entry {
  HapticDeviceKind kind;
  Made (*make)(const HapticDeviceOptions&);
};

constexpr Entry kDevices[] = {
    {HapticDeviceKind::kSimOmni, [](const auto& o) { return sim_omni(o.hand, false); }},
    {HapticDeviceKind::kSimOmniTorque, [](const auto& o) { return sim_omni(o.hand, true); }},
    {HapticDeviceKind::kRecorded, recorded},
    {HapticDeviceKind::kSimJoystick, sim_joystick},
    {HapticDeviceKind::kPage, page},
    {HapticDeviceKind::kSpaceMouse,
     [](const auto& o) { return Made(std::make_unique<SpaceMouseDevice>(o.spacemouse)); }},
    {HapticDeviceKind::kTouch,
     [](const auto& o) { return Made(std::make_unique<TouchDevice>(o.touch)); }},
    {HapticDeviceKind::kGamepad,
     [](const auto& o) { return Made(std::make_unique<GamepadDevice>(o.gamepad, kernel_of(o))); }},
    {HapticDeviceKind::kJoystick,
     [](const auto& o) { return Made(std::make_unique<ComediJoystick>(o.joystick)); }},
    {HapticDeviceKind::kForceStick,
     [](const auto& o) { return Made(std::make_unique<ForceStick>(o.force_stick, kernel_of(o))); }},
};

}  // namespace

HandOptions usual_hand(HapticDeviceKind kind, std::uint64_t seed) {
  if (kind == HapticDeviceKind::kSimJoystick) return joystick_grip(0.5, seed);
  HandOptions hand;
  if (kind == HapticDeviceKind::kPage) hand = page_hand();
  hand.seed = seed;
  return hand;
}

Made make_haptic_device(const HapticDeviceOptions& options) {
  for (const Entry& entry : kDevices) {
    if (entry.kind == options.kind) return entry.make(options);
  }
  return Status::error("device kind is " + std::to_string(static_cast<int>(options.kind)) +
                       ", expected a kind of the registry");
}

}  // namespace handrail
