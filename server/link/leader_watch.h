// When it is to be said that the other side is led by another.
#pragma once

#include <cstdint>

#include "server/link/peer.h"

namespace handrail {

// Says what has changed, once. That nobody says who leads for a while is no change. Real-time safe.
class LeaderWatch {
 public:
  enum class Change : std::uint8_t {
    kNone,
    kLed,     // by another than was said last, or at all
    kAnswers  // the other side speaks to us again, or for the first time
  };

  Change step(const LinkSnapshot& link, Nanos now) noexcept {
    if (link.refused(now)) {
      if (link.refusal.leader == leader_) return Change::kNone;
      leader_ = link.refusal.leader;
      return Change::kLed;
    }
    if (leader_ == LeaderName{} || link.received_at <= link.refused_at) return Change::kNone;
    leader_ = {};
    return Change::kAnswers;
  }

 private:
  LeaderName leader_{};  // said last; empty: nobody, or the other side has answered since
};

}  // namespace handrail
