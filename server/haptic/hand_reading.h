// Where the hand is, as the steps take it.
#pragma once

#include <algorithm>

#include "server/base/spatial.h"
#include "server/base/time.h"

namespace handrail {

inline constexpr double kFastestHand = 100.0;  // no hand moves so [m/s]
// A hand silent for longer takes over again like after a clutch, wherever it comes back [s].
inline constexpr double kLongestHandGap = 0.020;
// A device that was lost, and may be homed anew, is away for at least as long [s].
inline constexpr double kShortestLoss = 0.100;

// The device's newest reading, frame M.
struct HandReading {
  Pose X_MH;
  Vec3 v_MH = Vec3::Zero();    // [m/s]
  bool clutch_button = false;  // button 1, while held
  bool drop_button = false;    // button 2; acts when it goes down
  bool enable_button = false;  // button 3, while held
  bool valid = false;
  bool force_missed = false;  // what was written last came too late for the turn before this one
};

// For how long the hand was not heard: readings that were invalid, and time that nobody saw.
class HandGap {
 public:
  // A tick without a valid reading. `dt` [s] and `unseen` [ns] since the last tick.
  void goes_on(double dt, Nanos unseen) noexcept { for_ = std::min(after(dt, unseen), 1.0); }
  // A tick with one. Whether the hand takes over again, wherever it is: it was not heard for too
  // long, or not seen for so long that its device may have been lost.
  bool ends(double dt, Nanos unseen) noexcept {
    const double most = for_ > 0.0 ? kLongestHandGap : kShortestLoss;
    const bool lost = after(dt, unseen) > most;
    for_ = 0.0;
    return lost;
  }
  bool too_long() const noexcept { return for_ > kLongestHandGap; }

 private:
  double after(double dt, Nanos unseen) const noexcept {
    return for_ + std::max(dt, to_seconds(unseen));
  }

  double for_ = 0.0;  // since the last valid reading, at most 1 [s]
};

}  // namespace handrail
