// Whether a device's readings go faster than any hand.
#pragma once

#include <optional>
#include <string_view>

#include "devices/haptic_device.h"
#include "server/base/spatial.h"
#include "server/base/time.h"

namespace handrail {

// From one reading to the next, along one axis.
struct Leap {
  int axis = 0;      // 0 to 2
  double way = 0.0;  // signed [m]
  Nanos time = 0;    // that the way may have taken at most
};

// Follows the places that a device reads. What it judges by is the time from before the last
// reading to after this one, so that a reading which comes late is no leap. Each place is where the
// next is judged from, whether or not it was a leap. Real-time safe.
class LeapGuard {
 public:
  // Straight punches of Olympic boxers come at 9.14 m/s, with a deviation of 2.06 (Walilko, Viano
  // and Bir 2005, doi 10.1136/bjsm.2004.014126), and have more room to get so fast than a stick
  // has. Let go of under its motors' peak force the dissertation's joystick comes to less: 25 N
  // move 0.3 kg over 0.2 m to 5.8 m/s. [m/s]
  static constexpr double kFastest = 10.0;

  // `count`: the least step of each axis, >= 0 [m]; a reading of N counts is a way of more than
  // N - 1 of them. `age`: a reading may be so old when it comes, >= 0.
  explicit LeapGuard(const Vec3& count, Nanos age = 0) noexcept : count_(count), age_(age) {}

  // The next reading is the first.
  void reset() noexcept { known_ = false; }
  // A place in frame M, finite [m], and when its reading began and ended by monotonic_now(). Of
  // axes that leap at once the first is told; none after reset().
  std::optional<Leap> next(const Vec3& p_M, Nanos from, Nanos to) noexcept;

 private:
  Vec3 count_;
  Nanos age_;
  Vec3 last_ = Vec3::Zero();
  Nanos read_from_ = 0;  // when the last reading began
  bool known_ = false;
};

// "WHAT 28.3 mm, in 1.13 ms: 25 m/s, and at most 10 are a hand's; look at its cable". Real-time
// safe.
DeviceTrouble leap_text(const char* what, const Leap& leap) noexcept;

// "TROUBLE; NEXT", cut to what fits; as it is where NEXT is empty. Real-time safe.
DeviceTrouble and_then(const DeviceTrouble& trouble, std::string_view next) noexcept;

}  // namespace handrail
