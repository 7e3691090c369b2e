// One surface touched twice over a delayed link, by a simulated hand: how stiff it is felt.
#pragma once

#include <array>
#include <cstdint>

namespace handrail {

struct DelayCase {
  double stiffness = 50e3;     // of the surface; the arm's 60 N/mm are in series [N/m]
  double round_trip_ms = 0.0;  // of the link, half of it each way
  double jitter_ms = 0.0;      // uniform within +- each way, at most half the round trip
  double loss = 0.0;           // 0 to 0.5, each datagram by itself
  bool local = false;          // the surface is rendered at the master, else through the spring
  std::uint64_t seed = 1;      // of network, hand and rig
};

// What a touch came to. The hand means to go 8 mm past the surface, in 1.5 s, and stays. Depths are
// the hand's, behind the true surface; the true force is what that surface, rendered where the hand
// is, would push: the stiffness that both hold, at most, times the depth.
struct TouchFigures {
  double felt = 0.0;   // force per depth in the first second of it, least squares [N/m]
  double held = 0.0;   // the same in the last second of the hold [N/m]
  double error = 0.0;  // force, root of the mean square from the touch to the retreat [N]
  double drift = 0.0;  // of the command, most, from half a second after the press to the end of
                       // the hold; where the hand asks the tip to be [mm]
  double swing = 0.0;  // force, peak to peak in the last second of the hold [N]
};

struct DelayFigures {
  bool engaged = false;
  bool ended = false;           // the engagement did not last
  double true_stiffness = 0.0;  // at the hand [N/m]
  double held_share = 0.0;      // of the time of both touches the arm held, for want of news
  double off_mm = 0.0;  // of the tip after the last retreat, from where the hand asks it to be
  std::array<TouchFigures, 2> touch;

  bool stable() const noexcept { return touch[0].swing < kSwing && touch[1].swing < kSwing; }
  // Well below what a hand tells, 7 % (Jones 1989, force) of the 1.5 N that are pushed [N].
  static constexpr double kSwing = 0.1;
};

// Same case, same figures.
DelayFigures measure_delay(const DelayCase& of);

}  // namespace handrail
