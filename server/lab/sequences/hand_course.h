// A hand that does anything: pauses, wanders, jerks, trembles.
#pragma once

#include "server/haptic/hand_reading.h"
#include "server/lab/sequences/draw.h"

namespace handrail {

// Chosen: the fastest that people move a stylus, and what they turn it by.
inline constexpr double kFastestCourse = 1.0;    // [m/s]
inline constexpr double kFastestTurning = 10.0;  // [rad/s]

class HandCourse {
 public:
  explicit HandCourse(Draw& draw) noexcept;

  // Goes on for `elapsed` [s], within 0.15 m of the origin of frame M. What a device then reads,
  // without buttons; its velocity lags by 5 ms.
  HandReading move(Draw& draw, double elapsed) noexcept;

 private:
  enum class Gait { kPause, kWander, kJerk, kTremor };
  void begin(Draw& draw) noexcept;
  void choose_speed(Draw& draw, double elapsed) noexcept;

  Gait gait_ = Gait::kPause;
  double left_ = 0.0;                         // of this gait [s]
  double time_ = 0.0;                         // [s]
  double tremor_ = 10.0;                      // [Hz]
  Vec3 v_ = Vec3::Zero(), w_ = Vec3::Zero();  // [m/s], [rad/s]
  Vec3 v_to_ = Vec3::Zero(), w_to_ = Vec3::Zero();
  HandReading reading_;
};

}  // namespace handrail
