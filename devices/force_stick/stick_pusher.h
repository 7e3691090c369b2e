// The motors of a force-feedback joystick or wheel, behind a thread of their own.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "devices/evdev/force_feedback.h"
#include "devices/input/force_ramp.h"
#include "server/base/mailbox.h"
#include "server/base/plane.h"
#include "server/base/time.h"

namespace handrail {

struct StickForceOptions {
  int axes = 2;  // 1: X alone
  // What each axis makes at the kernel's full level; negative: it pushes the other way; 0: none.
  // The kernel has no unit of force. [N]
  std::array<double, 2> full{};
  Nanos period = 4 * kMillisecond;       // between two uploads, from a millisecond on
  Nanos most_upload = 4 * kMillisecond;  // an upload of both axes that takes longer is too late
};

// What the thread said last. Uploads are of both axes together.
struct StickPushed {
  bool there = false;         // the device takes uploads
  std::uint64_t uploads = 0;  // since start()
  std::uint64_t late = 0;     // of them took longer than they may
  std::uint64_t refused = 0;  // of them were not taken
  Nanos longest = 0;          // upload
  Vec2 force = Vec2::Zero();  // what acts [N]
};

// Of a constant effect of the kernel's. `level` along the direction.
struct StickLevel {
  std::uint16_t direction;  // the kernel's
  std::int16_t level;       // -32767 to 32767
};

// Axis 0 is right, axis 1 away from the user. `full` as in StickForceOptions. Pure.
StickLevel stick_level(int axis, double force, double full) noexcept;

// One constant effect an axis, so that a direction never leaps: uploaded as the force changes, and
// played. The force comes within half a second after it was none, and there is none 50 ms after
// push() was called last, and after an upload that was too late, till it comes back. Should this
// program be killed or stand still, the kernel ends the effects after kStickForceLasts. With the
// device: gain full, its own centring off.
//
// An upload may wait for the device: it is in no other thread.
//
// Source: Linux, Documentation/input/ff.rst.
class StickPusher final {
 public:
  // An effect ends by itself after so long, beyond kForceStands [ms].
  static constexpr std::uint16_t kStickForceLasts = 100;

  // The kernel lives as long as the program.
  StickPusher(EvdevKernel& kernel, const StickForceOptions& options);

  // Whether there is any force to make; without, start() starts nothing.
  bool makes_force() const noexcept;
  void start();
  // From here on at that device; one without a descriptor: at none. Real-time safe.
  void use(const EvdevOpened& device) noexcept {
    thread_.use(device.fd >= 0 ? device.path : FixedText<256>{});
  }
  // What is to act from `now` on [N]. Real-time safe.
  void push(Nanos now, const Vec2& force) noexcept {
    if (motors_) motors_->commands.publish({now, force});
  }
  // Takes what the thread said last. Real-time safe.
  const StickPushed& pushed() noexcept {
    if (motors_) (void)motors_->said.take(heard_);
    return heard_;
  }
  // No force, and the slots are given back. A device that answers late is left to the thread, which
  // then does so. Twice is fine.
  void stop() noexcept { thread_.stop(); }

 private:
  struct Command {
    Nanos at = -kForever;
    Vec2 force = Vec2::Zero();
  };
  struct Axis {
    ff_effect effect{};
    bool on = false;
  };

  // Of the thread, but for the mailboxes.
  class Motors final : public FeedbackWork {
   public:
    Motors(EvdevKernel& kernel, const StickForceOptions& options)
        : options_(options), motors_(kernel) {}
    Mailbox<Command> commands;
    Mailbox<StickPushed> said;

    void use(const FixedText<256>& path) noexcept override;
    void turn(Nanos now) noexcept override;
    void end() noexcept override;

   private:
    void tell(const Vec2& force, Nanos now) noexcept;
    bool show(const Vec2& force, Nanos now) noexcept;
    bool show_axis(Axis& axis, const StickLevel& wanted, bool goes_on) noexcept;

    StickForceOptions options_;
    ForceFeedback motors_;
    ForceRamp ramp_;
    Command command_;
    std::array<Axis, 2> axes_;
    StickPushed now_;
    Nanos last_turn_ = 0, played_at_ = 0, retry_at_ = 0;
  };

  EvdevKernel& kernel_;
  StickForceOptions options_;
  std::shared_ptr<Motors> motors_;
  StickPushed heard_;
  FeedbackThread thread_;
};

}  // namespace handrail
