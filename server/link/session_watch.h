// What a daemon's log says of its session.
#pragma once

#include <optional>
#include <string>

#include "server/base/time.h"
#include "server/model/link_state.h"
#include "server/model/reason.h"

namespace handrail {

class SessionWatch {
 public:
  // On a poor link holds come and go: one line of them in so long.
  static constexpr Nanos kHoldPause = kSecond;

  // A line when the session has changed, or a fault its cause: "session fault: ...". `why` gives a
  // reason in words. Allocates then.
  template <typename Why>
  std::optional<std::string> step(Nanos now, SessionState state, Reason reason, Why why) {
    const bool other_fault = state == SessionState::kFault && reason != reason_;
    if (state == state_ && !other_fault) return std::nullopt;
    const bool of_hold = leads(state) && leads(state_);
    if (of_hold && now < next_hold_) return std::nullopt;
    if (of_hold) next_hold_ = now + kHoldPause;
    state_ = state;
    reason_ = reason;
    std::string line = std::string("session ") + name_of(state);
    const bool says_why = reason != Reason::kNone && state != SessionState::kEngaged;
    if (says_why) line += std::string(": ") + std::string(why(reason));
    return line;
  }

 private:
  static bool leads(SessionState state) noexcept {
    return state == SessionState::kEngaged || state == SessionState::kHold;
  }

  SessionState state_ = SessionState::kOff;
  Reason reason_ = Reason::kNone;
  Nanos next_hold_ = -kForever;
};

}  // namespace handrail
