// A force-feedback joystick or wheel of the kernel's behind the interface of a haptic device.
#pragma once

#include <array>
#include <string>

#include "devices/evdev/evdev_reader.h"
#include "devices/evdev/pad.h"
#include "devices/force_stick/stick_pusher.h"
#include "devices/haptic_device.h"
#include "devices/input/leap_guard.h"

namespace handrail {

enum class ForceStickAxes : std::uint8_t {
  kStick,  // the kernel's X and Y
  kWheel,  // X alone, the wheel's angle
};

struct ForceStickOptions {
  std::string path;  // such as /dev/input/by-id/...-event-joystick; empty: the first one found
  ForceStickAxes axes = ForceStickAxes::kStick;
  // From the middle to an end of an axis, along the arc of the grip. The default is that of the
  // dissertation's joystick. > 0 [m]
  double reach = 0.1;
  // As StickForceOptions::full. [N]
  std::array<double, 2> full{};
  // The defaults: the middle of the 50 to 500 Hz at which drivers pass updates on, an upload that
  // takes no longer than that, and the longest delay that owners tell of; our choice. [s]
  double upload_period = 4e-3;
  double most_upload = 4e-3;
  double delay = 10e-3;  // of the device itself: to read an axis, and to make a force, >= 0
  // Least counts of an axis from end to end; that of ten bits is the least we know of.
  int axis_counts = 1023;
  // Of the moving parts at the grip. 0: not known.
  double mass = 0.0;      // [kg]
  double damping = 0.0;   // [N s/m]
  double friction = 0.0;  // [N]
  std::string input_folder = kInputFolder;
  Nanos reopen_pause = kReopenPause;  // from a millisecond on
};

// A joystick with two axes, or a wheel, that takes constant forces.
const PadWish& force_stick_wish(ForceStickAxes axes) noexcept;

// M: X right, Y up (away from the user on a desk); Z = 0. A wheel has Y = 0, and X is the way of
// its rim, positive clockwise.
//
// Where an axis is is read in the haptic thread; the force is in a thread of its own, StickPusher.
// Readings are not valid while the device is away, and while an axis reads as at its end and has
// not moved since it was opened: some read so until they are first moved. An axis that leaps, as no
// hand does within the time between two readings and the device's own delay, is one whose device is
// lost for at least a pause. Plugged in again the force begins anew. The buttons are those of a
// gamepad or joystick: clutch, drop, enable.
class ForceStick final : public HapticDevice {
 public:
  explicit ForceStick(const ForceStickOptions& options, EvdevKernel& kernel = evdev_kernel());
  ~ForceStick() override { close(); }

  const HapticCapabilities& capabilities() const override { return capabilities_; }
  // The error names the device, the cause and what to do; one that has coarser axes than
  // `axis_counts` is one.
  Status open() override;
  HapticSample read(Nanos now) noexcept override;
  DeviceTrouble trouble() const noexcept override;
  // Torque and Z are ignored; a force that is not finite counts as none.
  void write(const Wrench& f_H_M) noexcept override;
  void close() noexcept override;

  // What the motors' thread said last. Of the haptic thread.
  const StickPushed& pushed() noexcept { return pusher_.pushed(); }

 private:
  Result<EvdevOpened> open_device() const;
  bool moved_off(int axis) noexcept;
  Vec3 place() const noexcept;
  bool is_somewhere() noexcept;
  void lose(const Leap& leap, Nanos now) noexcept;

  ForceStickOptions options_;
  EvdevKernel& kernel_;
  HapticCapabilities capabilities_;
  EvdevReader reader_;
  StickPusher pusher_;
  std::array<bool, 2> known_{};  // where the axis is
  LeapGuard guard_;
  Nanos away_until_ = -kForever;  // by monotonic_now()
  DeviceTrouble lost_for_{};      // of a leap, until readings are valid again
  HapticSample sample_;
  Nanos last_ = 0;
  bool open_ = false;
  bool started_ = false;
};

}  // namespace handrail
