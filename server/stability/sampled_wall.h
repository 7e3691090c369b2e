// When a wall that a computer renders is stable, and what energy it makes.
//
// A wall holds its force for a period and knows only where the hand was. So it pushes longer on the
// way out than it has pushed on the way in: it makes energy, which the device has to take up.
#pragma once

#include <optional>

namespace handrail {

// A device without a hand, and how the loop renders a wall to it. The device is a mass with viscous
// damping: m x'' + b x' = F.
struct SampledWall {
  double mass = 0.0;          // that moves, > 0 [kg]
  double damping = 0.0;       // of the device, viscous, >= 0 [N s/m]
  double period = 1e-3;       // of the loop, > 0; a force is held for so long [s]
  double wall_damping = 0.0;  // rendered, >= 0 [N s/m]
  // Of the low-pass of the velocity, a backward difference, that the wall's damper gets: 0 <= p <
  // 1, v += (1 - p) (difference - v) a period; 0: none.
  double velocity_pole = 0.0;
  int delay = 0;  // from measuring to force beside that, >= 0 [periods]
  // And so much of a period beside, 0 <= late < 1: so long into each period the force of the one
  // before goes on.
  double late = 0.0;
};

// Whether a wall of `stiffness` [N/m] on both sides of zero lets every motion die away. Exact for
// this linear loop. Allocates, and its time goes with the square of the delay: not for a real-time
// loop.
bool is_stable(const SampledWall& wall, double stiffness);

// The least stiffness with which a motion does not die away any more [N/m], to 1e-9 of it; 0: with
// none does every motion die away, as without damping, or with more wall damping than the delay
// lets. As is_stable().
double stiffness_onset(const SampledWall& wall);

// The viscous damping with which the device takes up all that the wall makes, whatever hand holds
// it [N s/m]. Colgate and Schenkel (1997), worked out for whole periods of delay, a part of one
// counting as one; without wall damping it is K (T / 2 + delay), without delay K T / 2 + |B|.
// `stiffness` in N/m.
double passive_damping(const SampledWall& wall, double stiffness) noexcept;

// What a spring of `stiffness` [N/m], without damping, makes in a cycle of x = amplitude sin(2 pi f
// t) [J]: exact where the force is held for `period` and late by whole periods, `delay` [s] in all.
double energy_per_cycle(double stiffness, double amplitude, double frequency, double period,
                        double delay) noexcept;

// The amplitude of speed from which on an oscillation grows though the device's Coulomb friction
// [N] takes something of it [m/s]; nothing: none grows. By the describing function, (4 / pi) f_c /
// (K (T / 2 + delay) - b): up to 11 % below what a simulation with sticking gives while w (T / 2 +
// delay) < 0.4, w = sqrt(K / m), and more beyond; so it errs on the safe side. Wall damping is not
// looked at.
std::optional<double> speed_that_grows(const SampledWall& wall, double stiffness,
                                       double friction) noexcept;

}  // namespace handrail
