// Notices when a control loop no longer renews what its IO thread sends for it.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "server/base/time.h"

namespace handrail {

// How long what a loop says stands without being renewed, before the loop is said to stand still:
// as long as the other side would take an equally old datagram for alive.
inline constexpr Nanos kStateStands = 20 * kMillisecond;

// How long what the haptic loop says is sent: two of its rounds, since two clocks of 1 kHz that
// drift past each other send one state twice. The slave waits kStateStands from the last datagram
// on, so what is sent for longer makes it notice a stall later.
inline constexpr Nanos kHapticStateSent = 2 * kMillisecond;

// What a daemon's log says of a control loop that stands still. Asked about every tick of the IO
// thread, by the clock of that thread.
class StallWatch {
 public:
  // At most one line in so long: a machine that is overloaded stops a loop again and again.
  static constexpr Nanos kPause = kSecond;

  // `good_until`: when the newest state of the loop stops being true, kStateStands after it was
  // made. A line when a loop has stood still, with how long it was, and when it still does after
  // kPause. Allocates then.
  std::optional<std::string> step(Nanos now, Nanos good_until, const std::string& loop) {
    // One that ended before anybody looked: what was good is over, and the next came too late.
    const Nanos last = std::exchange(last_good_, good_until);
    const Nanos between = std::min(good_until, now + kStateStands) - last;
    if (now > last && between > kStateStands) {
      if (stood_ == 0) ++count_;
      longest_ = std::max(longest_, between);
    }
    stalled_ = now > good_until;
    if (stalled_) {
      const Nanos stood = now - good_until + kStateStands;
      if (stood_ == 0) ++count_;
      stood_ = stood;
      longest_ = std::max(longest_, stood);
      if (said_ || stood < kPause) return std::nullopt;
      said_ = true;
      next_ = now + kPause;
      return "the " + loop + " loop stands still: nothing is sent, the arm holds";
    }
    stood_ = 0;
    if (count_ == 0 || now < next_) return std::nullopt;
    next_ = now + kPause;
    const std::string times = count_ == 1 ? "" : std::to_string(count_) + " times, ";
    const std::string most = count_ == 1 ? "" : "up to ";
    std::string line = "the " + loop + " loop runs again: it stood still " + times + "for " + most +
                       std::to_string(longest_ / kMillisecond) +
                       " ms; the machine is overloaded, or was paused";
    count_ = 0;
    longest_ = 0;
    said_ = false;
    return line;
  }

  bool stalled() const noexcept { return stalled_; }

 private:
  bool stalled_ = false;
  bool said_ = false;  // of the present stall
  Nanos stood_ = 0;    // so far, of the present stall
  int count_ = 0;      // since the last line
  Nanos longest_ = 0;  // of them
  Nanos next_ = -kForever;
  Nanos last_good_ = kForever;  // at the last look
};

}  // namespace handrail
