// Notices when a control loop no longer renews what its IO thread sends for it.
#pragma once

#include "server/base/time.h"

namespace handrail {

// How long what a loop says stands without being renewed, before the loop is said to stand still:
// as long as the other side would take an equally old datagram for alive.
inline constexpr Nanos kStateStands = 20 * kMillisecond;

// How long what the haptic loop says is sent: two of its rounds, since two clocks of 1 kHz that
// drift past each other send one state twice. The slave waits kStateStands from the last datagram
// on, so what is sent for longer makes it notice a stall later.
inline constexpr Nanos kHapticStateSent = 2 * kMillisecond;

// Asked about every tick of the IO thread, by the clock of that thread. Real-time safe.
class StallWatch {
 public:
  enum class Change { kNone, kStalled, kRunsAgain };

  // `good_until`: when the newest state of the loop stops being true.
  Change step(Nanos now, Nanos good_until) noexcept {
    const bool was = stalled_;
    stalled_ = now > good_until;
    if (stalled_) stood_for_ = now - good_until;
    if (stalled_ == was) return Change::kNone;
    return stalled_ ? Change::kStalled : Change::kRunsAgain;
  }

  bool stalled() const noexcept { return stalled_; }
  // Of the present stall, or of the last one [ns].
  Nanos stood_for() const noexcept { return stood_for_; }

 private:
  bool stalled_ = false;
  Nanos stood_for_ = 0;
};

}  // namespace handrail
