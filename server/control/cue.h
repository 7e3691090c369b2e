// What the hand feels when force has left: short trembles that push it nowhere.
#pragma once

#include <cmath>
#include <cstdint>

namespace handrail {

enum class Cue : std::uint8_t {
  kNone,
  kHold,  // the link pauses: two trembles
  kLost   // the link is lost, somebody has to reset: three
};

// Force at `t` [s] after what it tells [N]: trembles of three whole periods, so without a mean,
// from when the fading force has left. Its slope stays within a step of 0.05 N a millisecond. Pure.
inline double cue_force(Cue cue, double t) noexcept {
  constexpr double kStart = 0.050, kTremble = 0.075, kEvery = 0.150;  // [s]
  constexpr double kSize = 0.15;                                      // [N]
  constexpr double kTurn = 2.0 * 3.14159265358979323846 * 40.0;       // [rad/s]
  const double since = t - kStart;
  const int trembles = cue == Cue::kHold ? 2 : cue == Cue::kLost ? 3 : 0;
  if (!(since >= 0.0 && since < trembles * kEvery)) return 0.0;
  const double within = std::fmod(since, kEvery);
  return within < kTremble ? kSize * std::sin(kTurn * within) : 0.0;
}

}  // namespace handrail
