// When a device that turns by itself will turn next.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>

#include "server/base/time.h"

namespace handrail {

// Learns the device's period from its turns. One that pauses 1 ms between two turns turns every
// 1.07 ms. Real-time safe.
class TurnClock {
 public:
  static constexpr Nanos kNominal = kMillisecond;

  // The device's turn of that number began at `at`; the numbers count up by one.
  void turned(std::uint32_t number, Nanos at) noexcept {
    const Nanos lasted = at - at_;
    if (number == number_ + 1 && std::abs(lasted - kNominal) <= kMostOff)
      period_ += (lasted - period_) / kMean;
    number_ = number;
    at_ = at;
  }
  // Of the turns to be expected after the newest, the one nearest to `due`, by the clock of `at`.
  // After a first turn.
  Nanos expected(Nanos due) const noexcept {
    const Nanos turns = (due - at_ + period_ / 2) / period_;
    return at_ + std::max<Nanos>(turns, 1) * period_;
  }
  Nanos period() const noexcept { return period_; }

 private:
  // A Touch makes 977 to 1013 turns in each second. A turn that took longer than this was late, and
  // says nothing of the next.
  static constexpr Nanos kMostOff = kNominal / 4;
  // Of so many turns the mean: single ones vary by 0.04 ms (Duefor/Geomagic_Touch_USB_personalSDK),
  // their mean by 0.01 ms.
  static constexpr Nanos kMean = 16;

  std::uint32_t number_ = 0;
  Nanos at_ = 0;
  Nanos period_ = kNominal;
};

}  // namespace handrail
