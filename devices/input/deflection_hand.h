// The hand of a device that tells how far it is pushed, and not where it is.
#pragma once

#include <cstdint>

#include "devices/haptic_device.h"

namespace handrail {

enum class DeflectionMode : std::uint8_t {
  kVelocity,  // the deflection is how fast the hand goes
  kPosition,  // the deflection is where the hand is
};

struct DeflectionSettings {
  DeflectionMode mode = DeflectionMode::kVelocity;
  // The defaults are our choice. A fifth of the 250 mm/s that ISO 10218-1 lets a tip go by hand.
  double speed = 0.05;      // kVelocity, of each axis at full deflection, > 0 [m/s]
  double turn_rate = 0.52;  // kVelocity, about each axis at full deflection, >= 0 [rad/s]
  double reach = 0.1;       // half of the work space; kPosition: at full deflection, > 0 [m]
  double tilt = 0.52;       // kPosition, about each axis at full deflection, >= 0 [rad]
};

// How far a device is pushed and turned, as shares of full deflection: -1 to 1 each. Frame M.
struct Deflection {
  Vec3 move = Vec3::Zero();
  Vec3 turn = Vec3::Zero();
};

// What such a device can do: no force, so its dynamics say nothing.
HapticCapabilities deflection_capabilities(const DeflectionSettings& settings);

// Turns deflections into a pose and a velocity in frame M. Steps of a deflection are smoothed, so
// that the hand has a velocity without leaps. kVelocity: the place stays within the work space and
// is kept while nothing is pushed. kPosition: it goes back to the middle as the device does.
// Real-time safe. Deterministic for the same calls.
class DeflectionHand {
 public:
  explicit DeflectionHand(const DeflectionSettings& settings) noexcept : settings_(settings) {}

  // To the middle, at rest.
  void reset() noexcept;
  // At rest where it is: nobody pushes any more, or nobody can tell.
  void halt() noexcept;
  // `dt` later, 0 to 1 s. Shares beyond -1 to 1 count as -1 or 1. `recentre`, kVelocity: whatever
  // is pushed, the place goes back to the middle of the work space, as a hand does that is free.
  void step(const Deflection& deflection, bool recentre, double dt) noexcept;

  const Pose& pose() const noexcept { return pose_; }
  const Vec3& velocity() const noexcept { return velocity_; }  // [m/s]

 private:
  void part(const Deflection& deflection, bool recentre, double dt) noexcept;

  DeflectionSettings settings_;
  Deflection halfway_, smooth_;  // after the first and the second lag
  Pose pose_;
  Vec3 velocity_ = Vec3::Zero();
};

}  // namespace handrail
