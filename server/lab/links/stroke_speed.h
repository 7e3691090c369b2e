// How fast the tip may go: its speed in strokes that the hand asks for faster than the arm can.
#pragma once

#include <algorithm>
#include <span>

#include "server/base/spatial.h"
#include "server/base/time.h"
#include "server/base/units.h"

namespace handrail {

class StrokeSpeed {
 public:
  // Chosen: a stroke that takes the arm to its full speed and back, eight times.
  static constexpr double kHalfStroke = 100.0 * kMm;
  static constexpr int kStrokes = 8;
  static constexpr double kEnds = 0.02;  // of a stroke, at either end, are not counted
  // Beside the way there and back.
  static constexpr Nanos kStrokeTime = 2 * kSecond;

  // The tip's place every `period` [s] of one stroke. Adds its way but for the ends, and the time
  // that took, unless it did not go half of it.
  void add(std::span<const Vec3> tip, double period) {
    if (tip.empty()) return;
    const Vec3 stroke = tip.back() - tip.front();
    const double length = stroke.norm();
    if (length < kHalfStroke) return;
    const auto reached = [&](double share) {
      return std::find_if(tip.begin(), tip.end(), [&](const Vec3& p) {
        return (p - tip.front()).dot(stroke) >= share * length * length;
      });
    };
    way_ += (1.0 - 2.0 * kEnds) * length;
    const auto steps = std::max<std::ptrdiff_t>(reached(1.0 - kEnds) - reached(kEnds), 1);
    time_ += period * static_cast<double>(steps);
  }
  // Of all strokes [m/s]; 0: there was none.
  double mean() const noexcept { return time_ > 0.0 ? way_ / time_ : 0.0; }

 private:
  double way_ = 0.0, time_ = 0.0;
};

}  // namespace handrail
