// A gamepad or joystick behind the interface of a haptic device.
#pragma once

#include <array>
#include <string>

#include "devices/evdev/evdev_reader.h"
#include "devices/evdev/pad.h"
#include "devices/evdev/rumble.h"
#include "devices/haptic_device.h"
#include "devices/input/deflection_hand.h"

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
  Nanos reopen_pause = kReopenPause;  // from a millisecond on
};

// One with two axes, and buttons of a gamepad or joystick.
const PadWish& gamepad_wish() noexcept;

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
  DeviceTrouble trouble() const noexcept override;
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
  EvdevReader reader_;
  Rumble rumble_;
  std::array<bool, kAxes> centred_{};  // has been in its middle since it was opened
  DeflectionHand hand_;
  HapticSample sample_;
  Nanos last_ = 0;
  bool open_ = false;
  bool started_ = false;
};

}  // namespace handrail
