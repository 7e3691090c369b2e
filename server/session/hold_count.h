// How often, and for how long, an arm stood for its link's sake.
#pragma once

#include <algorithm>

#include "server/base/time.h"
#include "server/model/link_state.h"
#include "server/model/reason.h"

namespace handrail {

// Real-time safe.
class HoldCount {
 public:
  // `elapsed` [ns] has passed since the step before; what the slave is in since. An engagement
  // counts from when the arm is free to follow: before, it waits for its master.
  void step(Nanos elapsed, SessionState state, Reason reason) noexcept {
    const bool engaged = state == SessionState::kEngaged || state == SessionState::kHold;
    const bool stands = state == SessionState::kHold || reason == Reason::kLinkHold;
    led_ = engaged && (led_ || !(stands || reason == Reason::kNotEngaged));
    const bool holds = led_ && stands;
    times_ += holds && stretch_ == 0;
    stretch_ = holds ? stretch_ + elapsed : 0;
    if (!holds) return;
    held_ += elapsed;
    longest_ = std::max(longest_, stretch_);
  }

  int times() const noexcept { return times_; }
  Nanos held() const noexcept { return held_; }        // all of them [ns]
  Nanos longest() const noexcept { return longest_; }  // [ns]

 private:
  bool led_ = false;
  int times_ = 0;
  Nanos held_ = 0, longest_ = 0, stretch_ = 0;
};

}  // namespace handrail
