// Where a device's own thread and the loop that renders at it meet, within the device's turn.
#pragma once

#include <cstdint>
#include <utility>

#include "devices/input/turn_bell.h"
#include "devices/input/turn_clock.h"
#include "server/base/clock.h"
#include "server/base/mailbox.h"
#include "server/base/spatial.h"
#include "server/base/time.h"

namespace handrail {

// A turn that is later than expected by so much is not waited for: the loop then goes on by its own
// clock, as long as the device is silent. It is what a device may cost the loop's punctuality, and
// more than its turns vary by: 0.04 ms (turn_clock.h).
inline constexpr Nanos kTurnPatience = 50 * kMicrosecond;
// A device's turn waits no longer for the force that answers its reading: a quarter of its period.
// The rest is the device's, for its bus. It is the force's delay at most, and so declared.
inline constexpr Nanos kAnswerPatience = 250 * kMicrosecond;

// Each turn the device's thread gives its reading, which wakes the loop, and waits a little for the
// force that the loop works out for it. A loop that did not answer in time, or that does not wait
// for turns at all, costs the device nothing but that: it goes on with the newest force that there
// is. No lock, no allocation.
template <typename Reading, typename Bell = TurnBell>
class TurnGate {
 public:
  // Before the device's thread starts, and with no other at it: nothing is there.
  void reset() noexcept {
    (void)turns_.take(newest_);
    newest_ = Turn();
    newest_.number = taken_ = turn_;
    newest_.missed = seen_missed_ = missed_;
    clock_ = TurnClock();
    silent_ = true;
    answers_.publish(Answer());
  }

  // The device's thread, once a turn: this is its reading. Real-time safe.
  void give(const Reading& reading, Nanos now) noexcept {
    if (++turn_ == 0) ++turn_;
    given_ = now;
    turns_.publish({reading, now, turn_, missed_});
    turn_bell_.ring(turn_);
  }
  // Then, once: the newest force, that for this turn where the loop writes it within
  // kAnswerPatience of give(); and when it was written. Real-time safe but that it waits, and that
  // only for a loop that answered one of the last turns.
  const Vec3& answer(Nanos& written) noexcept {
    (void)answers_.take(answer_);
    if (answer_.turn != 0 && turn_ - answer_.turn <= kAnswered) {
      wait_for_answer();
      if (answer_.turn != turn_) ++missed_;
    }
    written = answer_.at;
    return answer_.force;
  }

  // The loop: as HapticDevice::wait.
  Nanos wait(Nanos due) noexcept {
    waits_ = true;
    const Nanos next = silent_ ? due : clock_.expected(due);
    const Nanos until = silent_ ? due : next + kTurnPatience;
    for (;;) {
      const std::uint32_t heard = turn_bell_.now();
      hear();
      silent_ = newest_.number == taken_;
      if (!silent_) return newest_.at;
      if (!turn_bell_.wait(heard, until)) return next;
    }
  }
  // The newest reading; false, and `out` stays: there is none that was not taken before.
  bool take(Reading& out) noexcept {
    hear();
    if (newest_.number == taken_) return false;
    taken_ = newest_.number;
    out = newest_.reading;
    return true;
  }
  // Whether a force came too late for its turn since the last call, as far as is known from the
  // readings that were taken.
  bool missed() noexcept { return std::exchange(seen_missed_, newest_.missed) != newest_.missed; }
  void write(const Vec3& force) noexcept {
    answers_.publish({force, monotonic_now(), waits_ ? taken_ : 0});
    answer_bell_.ring(++written_);
  }

 private:
  // A loop that answered none of so many turns is not waited for: one that stands still must not
  // make the device late as well.
  static constexpr std::uint32_t kAnswered = 10;
  struct Turn {
    Reading reading{};
    Nanos at = -kForever;
    std::uint32_t number = 0;
    std::uint64_t missed = 0;  // forces, before this turn
  };
  struct Answer {
    Vec3 force = Vec3::Zero();  // [N]
    Nanos at = -kForever;
    std::uint32_t turn = 0;  // that it answers; 0: none
  };

  void hear() noexcept {
    if (turns_.take(newest_)) clock_.turned(newest_.number, newest_.at);
  }
  void wait_for_answer() noexcept {
    while (answer_.turn != turn_) {
      const std::uint32_t heard = answer_bell_.now();
      if (answers_.take(answer_)) continue;
      if (!answer_bell_.wait(heard, given_ + kAnswerPatience)) return;
    }
  }

  // Between the two.
  Mailbox<Turn> turns_;
  Mailbox<Answer> answers_;
  Bell turn_bell_, answer_bell_;

  // Of the device's thread.
  std::uint32_t turn_ = 0;
  Nanos given_ = 0;
  std::uint64_t missed_ = 0;
  Answer answer_;

  // Of the loop.
  Turn newest_;
  TurnClock clock_;
  std::uint32_t taken_ = 0, written_ = 0;
  std::uint64_t seen_missed_ = 0;
  bool waits_ = false;  // for turns, as a loop does that answers them
  bool silent_ = true;  // the device, as wait() last found it
};

}  // namespace handrail
