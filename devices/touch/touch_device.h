// A Touch, Phantom Omni or their like of 3D Systems, through the vendor's libHD.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <thread>

#include "devices/haptic_device.h"
#include "devices/input/leap_guard.h"
#include "devices/input/reopen_pause.h"
#include "devices/input/turn_gate.h"
#include "devices/touch/hd_api.h"

namespace handrail {

struct TouchOptions {
  // As the vendor's setup has it; empty: "Default Device", "Default PHANToM", then the default.
  std::string name;
  std::string library = "libHD.so";  // a path, or a name that the loader knows
  // One that fails in each turn, or does not turn, for so long is opened again; longer than a dip
  // of the bus. Our choice.
  Nanos lost_after = 500 * kMillisecond;
  Nanos reopen_pause = kReopenPause;  // from a millisecond on
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
  HdError error;                 // since the last tick, the first; code 0: none
  double temperature = 0.0;      // of the warmest motor, 0 to 1, where it has to rest
  std::uint64_t ticks = 0;       // since it was opened, the last time
  std::uint64_t frozen = 0;      // of these, in a row, with the very same place and angles
  std::uint64_t force_offs = 0;  // times the force was let go of, for an error or a hot motor
  std::uint64_t losses = 0;      // times that it was lost and opened again
  DeviceTrouble lost_for{};      // of a leap, until readings are valid again
};

// Reckoned with as a Touch, whatever the model: its data sheet's mass, friction, resolution and
// forces; a model with a lower nominal force gets no more than that. M is libHD's own frame: right,
// up, toward the user, about the middle of the work space.
//
// The vendor's servo thread, 1 kHz, calls in the loop: each of its turns gives a reading, and waits
// up to kAnswerPatience for the force that the loop works out for it. Not valid: before homing,
// while the device or its cable fails, and after 20 ms without a tick. The force is let go of by
// the servo thread after kForceStands, at an error, and while a motor is hot; half a second after
// an error it is switched on again and comes back within half a second.
//
// A device that is lost, unplugged, with a scheduler that stopped or with a place that leaps as no
// hand does, is closed and opened again by a thread of its own, every 100 ms until it works: homing
// is asked anew, and the force comes back as after an error.
class TouchDevice final : public HapticDevice {
 public:
  explicit TouchDevice(const TouchOptions& options);
  ~TouchDevice() override { close(); }

  const HapticCapabilities& capabilities() const override { return capabilities_; }
  // The error has the vendor's words and numbers, and what to do. Blocks until the first tick, or
  // for a second. A device that is not homed is opened.
  Status open() override;
  HapticSample read(Nanos now) noexcept override;
  DeviceTrouble trouble() const noexcept override;
  Nanos wait(Nanos due) noexcept override;
  void write(const Wrench& f_H_M) noexcept override;
  void close() noexcept override;

  // The newest tick that read() has seen.
  const TouchTick& tick() const noexcept { return tick_; }
  // As the vendor's library says; empty before open().
  const std::string& model() const noexcept { return model_; }
  const std::string& serial() const noexcept { return serial_; }
  const std::string& driver_version() const noexcept { return driver_version_; }

 private:
  Status begin(bool again);
  void end() noexcept;
  void watch() noexcept;
  Status init();
  void ask_identity();
  void ask_abilities();
  Status start(bool again);
  void servo() noexcept;
  void home(TouchTick& out) noexcept;
  void read_state(TouchTick& out) noexcept;
  bool may_push(const TouchTick& out) noexcept;
  Vec3 share_of(const Vec3& asked, Nanos written) const noexcept;
  void note_errors(TouchTick& out) noexcept;
  void look_for_leap(TouchTick& out) noexcept;

  TouchOptions options_;
  HapticCapabilities capabilities_;
  std::optional<HdApi> api_;
  HdHandle device_ = kHdNoDevice;
  unsigned long scheduled_ = 0;
  bool running_ = false;  // its scheduler does; of the watching thread while there is one
  bool open_ = false;     // for who reads
  std::string model_, serial_, driver_version_;

  TurnGate<TouchTick> gate_;  // between the two threads

  // What the servo thread tells the one that watches it, and that its end.
  std::atomic<std::uint64_t> turns_{0};
  std::atomic<bool> failing_{false};
  std::atomic<bool> stopping_{false};
  std::thread watcher_;

  // Of the servo thread.
  HdEnum style_ = 0;
  double most_force_ = 0.0;  // of this model [N]
  TouchTick servo_;
  bool output_ = false;  // the force is switched on
  bool hot_ = false;
  Nanos failed_at_ = -kForever;  // newest error that takes the force away
  LeapGuard guard_;
  bool leapt_ = false;  // since it was opened

  // Of who reads.
  TouchTick tick_;
};

}  // namespace handrail
