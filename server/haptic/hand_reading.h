// Where the hand is, as the steps take it.
#pragma once

#include "server/base/spatial.h"

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

}  // namespace handrail
