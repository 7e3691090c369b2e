// The haptic devices a configuration can name.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "devices/comedi/comedi_joystick.h"
#include "devices/evdev/gamepad_device.h"
#include "devices/force_stick/force_stick.h"
#include "devices/hand/hand_model.h"
#include "devices/haptic_device.h"
#include "devices/spacemouse/spacemouse_device.h"
#include "devices/touch/touch_device.h"
#include "server/base/status.h"

namespace handrail {

enum class HapticDeviceKind : std::uint8_t {
  kSimOmni,
  kSimOmniTorque,
  kRecorded,
  kSimJoystick,
  kPage,
  kSpaceMouse,
  kTouch,
  kGamepad,
  kJoystick,
  kForceStick,
  kCount
};

struct HapticDeviceOptions {
  HapticDeviceKind kind = HapticDeviceKind::kSimOmni;
  HandOptions hand;  // simulated devices
  // A CSV file, see load_recorded_motion. kRecorded: what is played; kSimJoystick: where the hand
  // means to go, if not empty.
  std::string recording_path;
  DeviceEffects effects;  // kSimJoystick
  SpaceMouseOptions spacemouse;
  TouchOptions touch;
  GamepadOptions gamepad;
  ComediJoystickOptions joystick;
  ForceStickOptions force_stick;
  EvdevKernel* evdev = nullptr;  // in the kernel's place, for tests; null: the kernel itself
};

// The hand that usually holds such a device: around a handle, a stylus, or led by a cursor.
HandOptions usual_hand(HapticDeviceKind kind, std::uint64_t seed);

// The device `options` ask for, not yet open. The error names the option or the file's line, the
// value and what was expected. May block and allocate.
Result<std::unique_ptr<HapticDevice>> make_haptic_device(const HapticDeviceOptions& options);

}  // namespace handrail
