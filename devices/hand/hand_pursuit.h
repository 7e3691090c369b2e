// How a person follows something that moves with the hand, such as a guiding ball.
#pragma once

#include "devices/hand/min_jerk.h"
#include "server/base/spatial.h"

namespace handrail {

struct PursuitOptions {
  double gain = 2.5;       // crossover frequency, 2 to 5 rad/s (McRuer) [1/s]
  double delay = 0.15;     // from eye to muscle, 0.15 to 0.3 s (McRuer) [s]
  double lead = 0.25;      // how far ahead an error is judged by its rate [s]
  double muscle = 0.08;    // lag of the movement itself [s]
  double most_lead = 0.1;  // of the intent before the hand: nobody pushes without end [m]
};

// The intent r that follows a target p, seen beside the hand x:
//
//   r' = v + gain (e + lead e'),  e = p - x as seen `delay` ago,
//
// through the muscles' lag: the crossover model of manual tracking (McRuer), where the target's own
// speed v is foreseen, as people foresee a steady motion. What holds the hand back is pushed
// against until the hand is with the target, as far as `most_lead` allows. The delay is three equal
// lags in a row. Pure; real-time safe.
class HandPursuit {
 public:
  explicit HandPursuit(const PursuitOptions& options = {}) noexcept : options_(options) {}

  // Begins with the intent where it is.
  void start(const VectorMotion& intent) noexcept;
  // One step of dt > 0 [s]: target and hand, the intent after it. Frame M.
  VectorMotion step(const VectorMotion& target, const VectorMotion& hand, double dt) noexcept;

 private:
  PursuitOptions options_;
  VectorMotion intent_;
  Vec3 seen_[3] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};  // the three lags [m/s]
};

}  // namespace handrail
