// What of a force that was asked for two motors may make.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "devices/input/force_ramp.h"
#include "devices/joystick/joystick_data.h"
#include "server/base/plane.h"
#include "server/base/time.h"

namespace handrail {

// The force comes within half a second, begins anew after it was not allowed or not renewed for
// kForceStands, and is never more than what the motors' peak torque makes at the tip, each by
// itself. What exceeds the rated torque for long is brought back to it. Real-time safe.
class JoystickForce {
 public:
  // `most`: at the tip, of each motor [N].
  explicit JoystickForce(double most) : most_(std::min(most, kJoystickPeakForce)) {}

  // What acts for the next `dt`. `asked` came at `asked_at`; not `allowed`: none.
  Vec2 step(const Vec2& asked, Nanos asked_at, bool allowed, Nanos now, Nanos dt) noexcept {
    const double share = ramp_.step(allowed && asked.allFinite(), asked_at, now, dt);
    if (share == 0.0) {
      cool(Vec2::Zero(), dt);
      return Vec2::Zero();
    }
    Vec2 out;
    for (int i = 0; i < 2; ++i) {
      const double room = hot_[static_cast<std::size_t>(i)] ? kJoystickRatedForce : most_;
      out[i] = share * std::clamp(asked[i], -room, room);
    }
    cool(out, dt);
    return out;
  }
  // It was more than the rated force for too long, and is held at that.
  bool hot() const noexcept { return hot_[0] || hot_[1]; }

 private:
  // A motor's windings of this size take some ten seconds to warm up; our choice.
  static constexpr double kWarming = 10.0;  // [s]
  static constexpr double kCooled = 0.8;    // of the rated square, from where the peak is back

  // The mean square of the force says what heats.
  void cool(const Vec2& force, Nanos dt) noexcept {
    const double follow = to_seconds(dt) / kWarming;
    const double rated = kJoystickRatedForce * kJoystickRatedForce;
    for (int i = 0; i < 2; ++i) {
      square_[i] += follow * (force[i] * force[i] - square_[i]);
      bool& hot = hot_[static_cast<std::size_t>(i)];
      hot = square_[i] >= rated || (hot && square_[i] >= kCooled * rated);
    }
  }

  double most_;
  ForceRamp ramp_;
  Vec2 square_ = Vec2::Zero();  // [N^2]
  std::array<bool, 2> hot_{};
};

}  // namespace handrail
