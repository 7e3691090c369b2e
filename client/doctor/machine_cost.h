// What the machine takes from programs that must be on time.
#pragma once

#include <string>

#include "server/base/time.h"

namespace handrail {

// From its construction on. The pauses are those of this program: what takes it away for long takes
// the others away too, or a part of them.
class MachineCost {
 public:
  MachineCost() noexcept : stolen_before_(stolen()) {}

  // A wait that should have ended at `due` ended at `now`.
  void waited(Nanos due, Nanos now) noexcept {
    if (now - due < kPause) return;
    ++pauses_;
    if (now - due > longest_) longest_ = now - due;
  }

  int pauses() const noexcept { return pauses_; }      // of 20 ms and more
  Nanos longest() const noexcept { return longest_; }  // of them
  // Time that the hypervisor gave to others while a processor of ours had work [s]; -1: this system
  // does not say.
  double stolen_s() const noexcept;
  // "no pause of 20 ms or more", "2 pauses of 20 ms or more, the longest 61 ms; 0.35 s stolen".
  std::string text() const;

 private:
  static constexpr Nanos kPause = 20 * kMillisecond;
  static double stolen() noexcept;

  double stolen_before_;
  int pauses_ = 0;
  Nanos longest_ = 0;
};

}  // namespace handrail
