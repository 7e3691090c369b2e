// A gamepad or joystick behind the interface of a haptic device.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "devices/evdev/evdev_file.h"
#include "devices/evdev/evdev_stream.h"
#include "devices/evdev/rumble.h"
#include "devices/haptic_device.h"
#include "devices/input/deflection_hand.h"
#include "devices/input/reopener.h"

namespace handrail {

struct GamepadOptions {
  std::string path;  // such as /dev/input/by-id/...-event-joystick; empty: the
                     // first one found
  DeflectionSettings motion;
  // Of a stick's way, about its middle, in which it counts as let go of, 0 to
  // 0.5. Our choice: sticks rest within some hundredths; the device's own
  // `flat` counts where it is more.
  double dead_share = 0.12;
  // Of what its motors do at most, with which cues and contact are told; 0: they are not.
  double rumble_share = 0.5;
  std::string input_folder = kInputFolder;
};

// An axis or a button of a device, as the kernel names it.
struct GamepadLayout {
  int right, toward, up,
      turn_right;            // axes: positive right, toward the user, down, clockwise
  int clutch, drop, enable;  // keys
};

// The layout of a gamepad (Linux, Documentation/input/gamepad.rst), or of a
// joystick.
const GamepadLayout& gamepad_layout(bool gamepad) noexcept;
bool is_gamepad(const EvdevOpened& device) noexcept;
// Has two axes, and buttons of a gamepad or joystick.
bool drives(const EvdevOpened& device) noexcept;

// The devices that may be gamepads: those that udev calls joysticks, else all
// input devices.
std::vector<std::string> gamepad_paths(const std::string& input_folder);

// Gamepad: left stick right and away, right stick up and turning about the
// vertical; left shoulder clutch, right shoulder enable (the dead-man), south
// button drops tools. Joystick: stick right and away, hat up and down, twist;
// trigger enable, second button clutch, third drop. Makes no force; one that
// has motors trembles for cues and contact. An axis
// counts only once it has been in its middle: some read as fully pushed until
// they are first moved. Unplugged, readings are invalid; plugged in again the
// hand goes on where it was.
class GamepadDevice final : public HapticDevice {
 public:
  explicit GamepadDevice(const GamepadOptions& options, EvdevKernel& kernel = evdev_kernel());
  ~GamepadDevice() override { close(); }

  const HapticCapabilities& capabilities() const override { return capabilities_; }
  // The error names the device, the cause and what to do.
  Status open() override;
  // Not valid while closed or unplugged. Takes at most 128 events; more wait
  // for the next.
  HapticSample read(Nanos now) noexcept override;
  void write(const Wrench&) noexcept override {}
  void feel(const HapticCue& cue) noexcept override { rumble_.feel(cue); }
  void close() noexcept override;

 private:
  static constexpr int kAxes = 4;

  Result<EvdevOpened> open_device() const;
  void receive() noexcept;
  double share(int which, int axis) noexcept;
  Deflection deflection() noexcept;
  std::uint32_t buttons() const noexcept;

  GamepadOptions options_;
  EvdevKernel& kernel_;
  HapticCapabilities capabilities_;
  Reopener<EvdevOpened> reopener_;
  Rumble rumble_;
  EvdevOpened opened_;
  EvdevStream stream_;
  std::array<bool, kAxes> centred_{};  // has been in its middle since it was opened
  DeflectionHand hand_;
  HapticSample sample_;
  Nanos last_ = 0;
  bool open_ = false;
  bool started_ = false;
};

}  // namespace handrail
