// Turns what an arm reports while somebody turns its tip about into samples for the payload's fit.
#pragma once

#include <cstddef>
#include <vector>

#include "server/base/units.h"
#include "server/task/payload_fit.h"

namespace handrail {

struct PayloadReading {
  double t = 0.0;  // [s]
  Pose X_ST;       // measured
  Wrench raw_T;    // of the sensor, with the payload's part, axes of the tip frame
};

// Takes the mean over every second in which the tip stays within 3 mm and 1.5 deg and gravity
// points, seen from the tip, 20 deg or more beside all samples so far.
class PayloadSampler {
 public:
  enum class State {
    kMoving,
    kStanding,  // in a new orientation, not yet long enough
    kTaken,     // this reading completed a sample
    kKnown,     // gravity points about as in a sample already taken
  };

  // The next reading, later than the one before.
  State add(const PayloadReading& reading);
  // Readings were missed or are not to be used: the standing time begins anew.
  void interrupt() { window_.clear(); }

  const std::vector<PayloadSample>& samples() const { return samples_; }
  // How long the tip has stood [s].
  double stood() const { return window_.empty() ? 0.0 : window_.back().t - window_.front().t; }
  // How far the newest reading was from where the tip stood before: [m], [rad].
  double moved() const { return moved_; }
  double moved_turn() const { return moved_turn_; }
  // From the nearest sample's direction of gravity to the newest reading's [rad]; pi without one.
  double turned() const { return turned_; }

  static constexpr double kStand = 1.0;  // [s]
  static constexpr double kTurn = 20.0 * kDeg;
  // A hand that holds the arm still drifts by a millimetre and a degree. That needs no force to
  // speak of, and pose and reading are means over the same time.
  static constexpr double kStill = 3.0 * kMm;
  static constexpr double kStillTurn = 1.5 * kDeg;

 private:
  std::vector<PayloadReading> window_;  // while standing
  std::vector<PayloadSample> samples_;
  double turned_ = 0.0;
  double moved_ = 0.0, moved_turn_ = 0.0;
};

}  // namespace handrail
