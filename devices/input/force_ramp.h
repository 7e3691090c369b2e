// How a force comes back that a device made none of for a while.
#pragma once

#include <algorithm>

#include "devices/haptic_device.h"
#include "server/base/time.h"

namespace handrail {

// Comes within half a second; begins anew after it was not allowed, or not renewed for
// kForceStands. Real-time safe.
class ForceRamp {
 public:
  // The share, 0 to 1, of a force asked for at `asked_at` that acts for the next `dt`.
  double step(bool allowed, Nanos asked_at, Nanos now, Nanos dt) noexcept {
    const bool acts = allowed && now - asked_at <= kForceStands;
    share_ = acts ? std::min(1.0, share_ + to_seconds(dt) / to_seconds(kRamp)) : 0.0;
    return share_;
  }

 private:
  static constexpr Nanos kRamp = 500 * kMillisecond;  // our choice

  double share_ = 0.0;
};

}  // namespace handrail
