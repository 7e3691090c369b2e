// What says that a force sensor repeats itself though it should not.
#pragma once

#include <array>
#include <cstdint>

#include "server/base/spatial.h"
#include "server/model/bumper_settings.h"

namespace handrail {

// A reading of the force sensor, and what the arm that carries it did.
struct WrenchReading {
  Wrench f_E_T;               // as the sensor says it, in its own axes
  bool fresh = false;         // new enough, and without a fault flag
  bool overrange = false;     // new enough, and the sensor says that an axis is beyond its range
  Pose X_ST;                  // the tip's place and the sensor's turn, measured
  bool still = false;         // no joint was told to move in the cycle before
  Vec3 own_T = Vec3::Zero();  // what the payload alone makes of it [N]
};

// Judges sound readings, once a cycle of about 7 ms. The same bits for 71 ms are a stuck sensor
//
// - where it has noise of its own: a reading that never repeated itself for a second, and that
//   trembles while no joint is told to move. Trembling is that every third reading in half a second
//   turns (rises after it fell, or falls after it rose), on one axis at least. White noise turns at
//   two readings of three, a random walk at every second. A load without noise does not: what the
//   arm still does when it is told to rest is a sum of decays, one a joint, and such a sum turns at
//   most five times; a person who leans on it turns it at most 24 times a second, at every sixth
//   reading. A load that the moving arm changes is never listened to.
// - where its load must have changed since they were first read: in a contact the measured tip has
//   gone half a millimetre into or out of every surface that could push so, or the payload's weight
//   has been turned by half a newton.
//
// Else nothing says that the load did not stand as still as the reading. Real-time safe.
class StuckMonitor {
 public:
  // True from the first cycle on in which the reading is known to be stuck. `dt`: cycle [s].
  bool judge(const BumperSettings& bumper, double dt, const WrenchReading& now) noexcept;

 private:
  static constexpr std::size_t kAxes = 6;

  void listen(const Wrench& f, bool still) noexcept;

  // The first two with these bits: one may be of a wild reading of the encoders.
  WrenchReading first_, second_;
  bool known_ = false;
  int repeating_ = 0;  // readings in a row that were the same bits again
  int overdue_ = 0;    // of them, the newest in a row whose load must have changed
  int changing_ = 0;   // readings in a row that were not
  int listened_ = 0;   // of them, since the joints are told to rest
  std::array<std::int8_t, kAxes> rising_{};  // 1, -1: how the axis went last
  std::array<int, kAxes> turns_{};           // among those listened to
  bool trembles_ = false;
  bool noisy_ = false;
};

}  // namespace handrail
