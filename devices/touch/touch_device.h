// A Touch, Phantom Omni or their like of 3D Systems, through the vendor's libHD.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

#include "devices/haptic_device.h"
#include "devices/touch/hd_api.h"
#include "server/base/mailbox.h"

namespace handrail {

struct TouchOptions {
  // As the vendor's setup has it; empty: "Default Device", "Default PHANToM", then the default.
  std::string name;
  std::string library = "libHD.so";  // a path, or a name that the loader knows
};

// Where it is with its own calibration.
enum class TouchHoming : std::uint8_t {
  kDone,
  kByItself,  // goes on without anybody
  kInkwell,   // the stylus has to be put into the inkwell
  kByHand,    // as the vendor's manual says of this model
};

// What the vendor's servo thread said last.
struct TouchTick {
  Nanos at = -kForever;
  HapticSample sample;
  TouchHoming homing = TouchHoming::kByHand;
  HdError error;                 // of this tick, the first; code 0: none
  double temperature = 0.0;      // of the warmest motor, 0 to 1, where it has to rest
  std::uint64_t ticks = 0;       // since it was opened
  std::uint64_t frozen = 0;      // of these, in a row, with the very same place and angles
  std::uint64_t force_offs = 0;  // times the force was let go of, for an error or a hot motor
};

// Reckoned with as a Touch, whatever the model: its data sheet's mass, friction, resolution and
// forces; a model with a lower nominal force gets no more than that. M is libHD's own frame: right,
// up, toward the user, about the middle of the work space.
//
// Readings come from the vendor's servo thread, 1 kHz. Not valid: before homing, while the device
// or its cable fails, and after 20 ms without a tick. The force is let go of by the servo thread
// after kForceStands, at an error, and while a motor is hot; half a second after an error it is
// switched on again and comes back within half a second.
class TouchDevice final : public HapticDevice {
 public:
  explicit TouchDevice(const TouchOptions& options);
  ~TouchDevice() override { close(); }

  const HapticCapabilities& capabilities() const override { return capabilities_; }
  // The error has the vendor's words and numbers, and what to do. Blocks until the first tick, or
  // for a second. A device that is not homed is opened.
  Status open() override;
  HapticSample read(Nanos now) noexcept override;
  void write(const Wrench& f_H_M) noexcept override;
  void close() noexcept override;

  // The newest tick that read() has seen.
  const TouchTick& tick() const noexcept { return tick_; }
  // As the vendor's library says; empty before open().
  const std::string& model() const noexcept { return model_; }
  const std::string& serial() const noexcept { return serial_; }
  const std::string& driver_version() const noexcept { return driver_version_; }

 private:
  struct Command {
    Nanos at = -kForever;
    Vec3 force = Vec3::Zero();
  };

  Status init();
  void ask_identity();
  Status start();
  void servo() noexcept;
  void home(TouchTick& out) noexcept;
  void read_state(TouchTick& out) noexcept;
  Vec3 force_now(const TouchTick& out) noexcept;
  void note_error(TouchTick& out) noexcept;

  TouchOptions options_;
  HapticCapabilities capabilities_;
  std::optional<HdApi> api_;
  HdHandle device_ = kHdNoDevice;
  unsigned long scheduled_ = 0;
  bool running_ = false;
  std::string model_, serial_, driver_version_;

  // Between the two threads.
  Mailbox<TouchTick> ticks_;
  Mailbox<Command> commands_;

  // Of the servo thread.
  HdEnum style_ = 0;
  double most_force_ = 0.0;  // of this model [N]
  TouchTick servo_;
  Command command_;
  bool output_ = false;  // the force is switched on
  bool hot_ = false;
  Nanos failed_at_ = -kForever;  // newest error that takes the force away

  // Of who reads.
  TouchTick tick_;
};

}  // namespace handrail
