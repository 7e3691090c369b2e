// What the arm does as the newest command ages: the degradation ladder.
#pragma once

#include <cstdint>

#include "server/base/reason.h"
#include "server/base/time.h"

namespace handrail {

enum class Rung : std::uint8_t {
  kNormal,  // follow
  kSlow,    // follow toward the last command, never beyond it, at `factor` of the speed
  kHold,    // stop on the path; resumes by itself
  kLost,    // latched until the operator resets
  kClosed,  // the session is over
};

inline constexpr Nanos kSlowAge = 5 * kMillisecond;
inline constexpr Nanos kHoldAge = 20 * kMillisecond;
inline constexpr Nanos kLostAge = 200 * kMillisecond;
inline constexpr Nanos kClosedAge = kSecond;

struct LadderStep {
  Rung rung = Rung::kClosed;
  double factor = 0.0;  // share of the speed, 1 at kSlowAge falling to 0 at kHoldAge
  Reason reason = Reason::kNone;
};

// `age` = time since the last fresh datagram [ns]; kForever when there was none. Each limit itself
// still belongs to the milder rung. Pure, real-time safe.
constexpr LadderStep ladder(Nanos age) noexcept {
  if (age <= kSlowAge) return {Rung::kNormal, 1.0, Reason::kNone};
  if (age <= kHoldAge) {
    const double left = static_cast<double>(kHoldAge - age);
    return {Rung::kSlow, left / static_cast<double>(kHoldAge - kSlowAge), Reason::kLinkStale};
  }
  if (age <= kLostAge) return {Rung::kHold, 0.0, Reason::kLinkHold};
  if (age <= kClosedAge) return {Rung::kLost, 0.0, Reason::kLinkLost};
  return {Rung::kClosed, 0.0, Reason::kSessionClosed};
}

}  // namespace handrail
