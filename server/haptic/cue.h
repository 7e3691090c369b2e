// What the hand feels beside forces: short trembles that push it nowhere, a pattern for each cause.
#pragma once

#include <cstdint>

#include "server/haptic/ledger.h"

namespace handrail {

enum class Cue : std::uint8_t {
  kNone,
  kHold,        // the link pauses: two trembles, once
  kLost,        // the link is lost, somebody has to reset: three, once
  kLimit,       // reach, range or speed keeps the arm back: one every 0.5 s while it does
  kSingularity  // a singular pose does: four finer ones every 0.7 s
};

// Force at `t` [s] after `cue` began [N], along one axis: trembles of three whole periods, so
// without a mean. Its slope stays within a step of 0.05 N a millisecond. Pure.
double cue_force(Cue cue, double t) noexcept;
// The largest it makes [N].
inline constexpr double kLargestCue = 0.15;

// What keeps the arm back from where the hand wants it, and for how long. Real-time safe.
class KeptBack {
 public:
  // One tick of `dt` [s]; the slave commands the tip to `p_ST`, frame S [m]. A cue once reach,
  // limits or singularity have kept it back for 100 ms by 2 mm more than any moving arm lags, until
  // that is under 1 mm or they no longer act. An unknown ledger keeps nothing back.
  Cue step(const MotionLedger& ledger, const Vec3& p_ST, double dt) noexcept;

 private:
  Vec3 last_p_ST_ = Vec3::Zero();
  double speed_ = 0.0;   // of the tip, low-passed [m/s]
  double lasted_ = 0.0;  // [s], at most 1
};

// Plays cues one after the other and each tremble to its end: one cut off would push.
class CuePlayer {
 public:
  // One tick of `dt` [s]. `news`: has just happened, played as soon as no tremble runs. `lasting`:
  // acts now, repeated while it does. Returns the force [N]. Real-time safe.
  double step(Cue news, Cue lasting, double dt) noexcept;

  // What plays, its pauses included; kNone: nothing. Real-time safe.
  Cue plays() const noexcept;
  // A tremble of it runs.
  bool trembles() const noexcept;

  // In place of a step while the device's force is cut: what runs is over, so that it does not come
  // back in the middle of a tremble; `news` is played afterwards. Real-time safe.
  void cut(Cue news) noexcept;

 private:
  Cue cue_ = Cue::kNone;
  Cue next_ = Cue::kNone;
  double age_ = 0.0;  // of cue_ [s]
};

}  // namespace handrail
