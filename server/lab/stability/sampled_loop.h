// A plain sampled wall at a bare device: what theory speaks of.
#pragma once

#include <deque>
#include <functional>

#include "server/lab/stability/bare_device.h"
#include "server/stability/sampled_wall.h"

namespace handrail {

// A spring, and a damper of the backward difference, on both sides of zero; its force is held for a
// period and late by `delay` and `late` of the wall. One line of BareDevice.
class SampledLoop {
 public:
  // `stiffness` [N/m], `friction` of the device, Coulomb [N]; at rest in the middle of the wall.
  SampledLoop(const SampledWall& wall, double stiffness, double friction = 0.0);

  void kick(double speed) noexcept { device_.kick({speed, 0.0}); }  // [m/s]
  void tick();

  double position() const noexcept { return device_.position().x(); }  // [m]
  double speed() const noexcept { return device_.velocity().x(); }     // [m/s]

 private:
  SampledWall wall_;
  double stiffness_;
  BareDevice device_;
  double last_ = 0.0;          // position a tick before [m]
  std::deque<double> forces_;  // on their way [N]
};

// How fast what `next` gives, tick by tick, grows: an oscillation about zero of about `swing`
// ticks, on its own after `settle` ticks [1/s]. Below 0: it dies away.
double growth_of(const std::function<double()>& next, int swing, int settle, double period);

// How fast an oscillation grows: of its size, over many periods after a kick [1/s]. Below 0: it
// dies away. Without friction it does not depend on the kick.
double growth_rate(const SampledWall& wall, double stiffness);

// The stiffness, of those within `within` of `near`, at which growth begins [N/m]; `near` itself
// times 1 +- within where it begins before or after.
double measured_onset(const SampledWall& wall, double near, double within);

// The least speed amplitude from which on an oscillation grows in spite of `friction` [m/s], to
// 0.5 %, sought from `near` / 4 to 4 `near`.
double measured_speed_that_grows(const SampledWall& wall, double stiffness, double friction,
                                 double near);

}  // namespace handrail
