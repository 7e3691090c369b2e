// How a drive through the screw-fastening task is judged, the same in all modes.
#pragma once

#include "server/model/screw_task.h"
#include "server/task/linear_measure.h"

namespace handrail {

// SI, on the true contact force, unfiltered.
struct ScrewMeasured {
  double path = 0.0;          // of the tip, by vertices 0.5 mm apart [m]
  double mean_force = 0.0;    // over the time with more than kTouching; 0 without any [N]
  double max_force = 0.0;     // [N]
  double impulse = 0.0;       // of the force over the time with more than kTouching [N s]
  double contact_time = 0.0;  // with more than kTouching [s]
};

// Takes finite samples. Pure.
class ScrewMeasure {
 public:
  static constexpr double kTouching = 2.0;  // [N]

  // `dt` seconds passed with the tip now at `p_ST` and the force of `force` N on it.
  void add(double dt, const Vec3& p_ST, double force) noexcept;
  ScrewMeasured measured() const noexcept;

 private:
  PathLength path_;
  double max_ = 0.0;
  double impulse_ = 0.0;
  double contact_ = 0.0;
};

}  // namespace handrail
