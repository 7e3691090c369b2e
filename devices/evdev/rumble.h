// The motors of a gamepad, for what is to be felt beside force.
#pragma once

#include <memory>

#include "devices/evdev/force_feedback.h"
#include "devices/haptic_device.h"
#include "server/base/clock.h"
#include "server/base/mailbox.h"

namespace handrail {

// How strong the two motors are, in the kernel's counts.
struct RumbleStrength {
  std::uint16_t strong = 0, weak = 0;  // the slow and heavy one, the fast and light one
  bool off() const { return strong == 0 && weak == 0; }
  friend bool operator==(const RumbleStrength&, const RumbleStrength&) = default;
};

// Contact and limits are for the heavy motor, the link and poses for the light one; `share` of what
// they can do, 0 to 1, at most. Pure.
RumbleStrength rumble_of(const HapticCue& cue, double share) noexcept;

// Uploads and plays in a thread of its own, of low priority: an upload waits for the device. What
// is felt ends 60 ms at the latest after feel() was called last; whatever becomes of this program,
// the kernel ends it after kRumbleLasts. A device that cannot rumble, or may not be written to,
// stays still.
//
// Source: Linux, Documentation/input/ff.rst and include/uapi/linux/input.h.
class Rumble final {
 public:
  // An effect ends by itself after so long [ms].
  static constexpr std::uint16_t kRumbleLasts = 200;

  // The kernel lives as long as the program.
  Rumble(EvdevKernel& kernel, double share) : kernel_(kernel), share_(share), thread_(kPeriod, 0) {}

  // Starts the thread; without a share there is none.
  void start();
  // From here on at that device, if it can rumble; one without a descriptor: at none. Real-time
  // safe.
  void use(const EvdevOpened& device) noexcept {
    const bool can = device.fd >= 0 && device.has_effect[FF_RUMBLE];
    thread_.use(can ? device.path : FixedText<256>{});
  }
  // What is felt now. Real-time safe.
  void feel(const HapticCue& cue) noexcept {
    if (motors_) motors_->told.publish({cue, monotonic_now()});
  }
  // Still, and the device is let go; a device that answers late is left to the thread. Twice is
  // fine.
  void stop() noexcept { thread_.stop(); }

 private:
  static constexpr Nanos kPeriod = 10 * kMillisecond;

  struct Told {
    HapticCue cue;
    Nanos at = -kForever;
  };

  // Of the thread, but for `told`.
  class Motors final : public FeedbackWork {
   public:
    Motors(EvdevKernel& kernel, double share) : share_(share), motors_(kernel) {}
    Mailbox<Told> told;

    void use(const FixedText<256>& path) noexcept override;
    void turn(Nanos now) noexcept override;
    void end() noexcept override;

   private:
    void show(const RumbleStrength& wanted, Nanos now) noexcept;

    double share_;
    ForceFeedback motors_;
    Told felt_;
    ff_effect effect_{};
    RumbleStrength shown_;
    Nanos shown_at_ = 0;
  };

  EvdevKernel& kernel_;
  double share_;
  std::shared_ptr<Motors> motors_;
  FeedbackThread thread_;
};

}  // namespace handrail
