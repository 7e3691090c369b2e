// When the thread that serves the link asks the kernel again and again instead of sleeping until it
// is woken.
#pragma once

#include "server/base/time.h"
#include "server/link/peer.h"

namespace handrail {

// Waking a thread is most of what a round trip costs within a computer. Who polls saves that, and
// takes a processor for it while the other side is heard. A real-time thread that never sleeps
// would be stopped: Linux takes a twentieth of each second away from those that use all of it
// (kernel.sched_rt_runtime_us, 950 of 1000 ms). So it rests for twice as much, after each tick.
// Real-time safe.
class BusyPoll {
 public:
  static constexpr Nanos kRest = kSendPeriod / 10;  // of a tick's period
  // Silent for longer, which is when the arm stops, the other side is not waited for that way.
  static constexpr Nanos kHeard = 20 * kSendPeriod;

  // Off until then.
  void turn_on() noexcept { on_ = true; }
  bool on() const noexcept { return on_; }
  // A tick ended at `now`; the newest datagram of the other side came at `heard`.
  void ticked(Nanos now, Nanos heard) noexcept {
    until_ = now + kSendPeriod;
    from_ = now - heard <= kHeard ? now + kRest : until_;
  }
  // Whether to poll at `now`. Where ticks are late it sleeps until the next.
  bool polls(Nanos now) const noexcept { return on_ && from_ <= now && now < until_; }

 private:
  bool on_ = false;
  Nanos from_ = 0, until_ = 0;
};

}  // namespace handrail
