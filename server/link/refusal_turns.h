// Whom a slave tells next that another master leads it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "server/base/time.h"

namespace handrail {

// A slave says at most this often that another master leads it, to all together: what a flood of
// datagrams costs.
inline constexpr Nanos kRefusalPeriod = 10 * kMillisecond;
// And to one session at most this often: what it says is believed for five times as long.
inline constexpr Nanos kRefusalRest = 200 * kMillisecond;

// Rounds: nobody is told twice before everybody who speaks has been told once, as whoever speaks
// first after each answer would else be the only one told. 50 who wait are each told every 0.5 s.
class RefusalTurns {
 public:
  // `session` was refused: true when it is to be told so now. Bounded and real-time safe.
  bool take(std::uint64_t session, Nanos now) noexcept {
    if (count_ != 0) {
      if (now - told_at_ < kRefusalPeriod) return false;
      const auto end = told_.begin() + static_cast<std::ptrdiff_t>(count_);
      if (std::find(told_.begin(), end, session) == end) {
        if (count_ == told_.size()) count_ = 0;
      } else {
        // Who has not been told yet would have spoken: a master does so every millisecond.
        const bool all_told = now - told_at_ >= 2 * kRefusalPeriod;
        if (!all_told || now - began_ < kRefusalRest) return false;
        count_ = 0;
      }
    }
    if (count_ == 0) began_ = now;
    told_[count_++] = session;
    told_at_ = now;
    return true;
  }

 private:
  // Whom this round has told. Of more who wait than that, the last to speak may not be told.
  std::array<std::uint64_t, 64> told_{};
  std::size_t count_ = 0;
  Nanos began_ = 0, told_at_ = 0;  // the round; the last answer
};

}  // namespace handrail
