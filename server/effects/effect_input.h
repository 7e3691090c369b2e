// What every effect of a two-axis scene is given, and what it may tell. Frame of the walls, SI.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "server/base/plane.h"
#include "server/model/effect_list.h"
#include "server/model/walls.h"

namespace handrail {

// One tick's view of the hand among the walls. Finite; `dt` > 0.
struct EffectInput {
  Vec2 hand = Vec2::Zero();            // [m]
  Vec2 velocity = Vec2::Zero();        // of the hand, as the device gives it [m/s]
  Vec2 proxy = Vec2::Zero();           // in free space [m]
  const WallRegion* region = nullptr;  // that the proxy is in; never null in a step
  const WallRegion* wall = nullptr;    // that is touched; null while the hand is free
  // Of each place of the detent [N]; null: as the scene lists them.
  const std::vector<double>* detent_peaks = nullptr;
  double dt = 1e-3;       // [s]
  double screw_c = -1.0;  // that progressive friction moves to [N s/(m rad)]; below 0: the scene's
};

// Time constant with which what a wall, a region or a place is to the hand becomes what another is,
// where the hand goes there or a stage changes it [s]. Chosen: shorter is felt as a step.
inline constexpr double kEffectChange = 0.020;

// The share of such a change that `dt` brings [s].
inline double changed_in(double dt) noexcept {
  return dt < kEffectChange ? dt / kEffectChange : 1.0;
}

// The least that effects may count on about device and hand. All > 0 but the lag.
struct Plant {
  double least_mass = 0.5;    // device and hand together [kg]
  double velocity_lag = 0.0;  // of the device's velocity, >= 0 [s]
  double most_force = 25.0;   // of the device [N]
};

struct EffectEvent {
  enum class Kind : std::uint8_t { kLocked, kUnlocked, kReturned };
  Kind kind = Kind::kLocked;
  int place = 0;  // locked, unlocked: index into the detent's places
};

// What one tick of the effects came to.
struct EffectTick {
  Vec2 force = Vec2::Zero();    // on the hand [N]
  Vec2 springs = Vec2::Zero();  // of it, what springs give: what they took comes back [N]
  // Of those among them that nothing makes up for being held for a period [N/m].
  double held_stiffness = 0.0;
  bool locked = false;  // a detent holds the hand
  int place = -1;       // which of its places does; -1: none
  std::array<EffectEvent, 4> events{};
  int event_count = 0;

  void by_spring(const Vec2& f, double held = 0.0) noexcept {
    springs += f;
    held_stiffness += held;
  }

  void tell(EffectEvent event) noexcept {
    if (event_count < static_cast<int>(events.size())) {
      events[static_cast<std::size_t>(event_count++)] = event;
    }
  }
};

// A share that moves between 0 and 1 within 50 ms, so that no force starts or ends with a step.
class Fade {
 public:
  double move(bool on, double dt) noexcept {
    constexpr double kTime = 0.050;  // [s]
    const double step = dt / kTime;
    share_ = on ? (share_ + step < 1.0 ? share_ + step : 1.0)
                : (share_ - step > 0.0 ? share_ - step : 0.0);
    return share_;
  }
  double share() const noexcept { return share_; }

 private:
  double share_ = 0.0;
};

}  // namespace handrail
