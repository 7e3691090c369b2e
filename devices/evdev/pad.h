// What gamepads, joysticks and wheels have in common: where they are, and what their buttons mean.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "devices/evdev/evdev_file.h"
#include "devices/evdev/evdev_stream.h"
#include "server/base/status.h"

namespace handrail {

// How udev ends the names of gamepads and joysticks (systemd, 60-persistent-input.rules).
inline constexpr char kJoystickEnding[] = "-event-joystick";

// An axis or a button of a device, as the kernel names it.
struct GamepadLayout {
  int right, toward, up,
      turn_right;            // axes: positive right, toward the user, down, clockwise
  int clutch, drop, enable;  // keys
};

// The layout of a gamepad (Linux, Documentation/input/gamepad.rst), or of a joystick.
const GamepadLayout& gamepad_layout(bool gamepad) noexcept;
bool is_gamepad(const EvdevOpened& device) noexcept;
// Its buttons in a HapticSample: clutch, drop, enable. Real-time safe.
std::uint32_t pad_buttons(const EvdevOpened& device, const EvdevState& state) noexcept;

// The devices that may be gamepads: those that udev calls joysticks, else all input devices.
std::vector<std::string> gamepad_paths(const std::string& input_folder);

// Which of them is wanted, and how its driver says so.
struct PadWish {
  const char* name;    // "gamepad"
  const char* any;     // "no gamepad and no joystick": that there is none
  const char* lacks;   // "has no stick with two axes and buttons"
  const char* wanted;  // "a gamepad or joystick"
  const char* option;  // where the configuration names it: "device.gamepad.device"
  bool (*fits)(const EvdevOpened& device);
  std::string (*kind)(const EvdevOpened& device);  // "a gamepad"
};

// The device of `path`, or where that is empty the first that fits. The error names it, the cause
// and what to do. Waits for nobody.
Result<EvdevOpened> open_pad(EvdevKernel& kernel, const std::string& path,
                             const std::string& input_folder, const PadWish& wish);

// What HapticDevice::trouble says of one that is away.
inline constexpr char kUnpluggedInput[] =
    "it is unplugged, or may not be opened: handrail devices list";

}  // namespace handrail
