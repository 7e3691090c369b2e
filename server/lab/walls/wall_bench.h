// A simulated joystick in a hand among the walls of a scene, in virtual time.
#pragma once

#include <memory>
#include <optional>

#include "devices/joystick/sim_joystick.h"
#include "server/haptic/wall_step.h"
#include "server/model/scene.h"

namespace handrail {

inline constexpr double kBenchTick = 1e-3;  // the haptic period [s]

// The first effect of that kind; null: the scene lists none.
const EffectSpec* effect_of(const Scene& scene, EffectKind kind);

// What was true and what was rendered in one tick. Frame of the walls, SI.
struct WallTick {
  double t = 0.0;                // since the first [s]
  Vec2 hand = Vec2::Zero();      // where the handle truly is [m]
  Vec2 velocity = Vec2::Zero();  // its own [m/s]
  Vec2 handle = Vec2::Zero();    // force of the hand on the handle, as a sensor there feels it [N]
  Vec2 effort = Vec2::Zero();    // the same with what moves the hand's own mass: the muscles' [N]
  Vec2 device = Vec2::Zero();    // force of the device on the handle for the next tick [N]
  Vec2 wall = Vec2::Zero();      // what of it the walls alone want, before the device's limits [N]
  WallContact contact;           // of the reading, one count of the encoders from the truth
  EffectTick effects;
  double turned = 0.0;       // angle of the progressive friction [rad]; 0 without one
  Vec2 ball = Vec2::Zero();  // guiding ball, where there is one [m]

  double depth() const { return contact.touching ? (hand - contact.proxy).norm() : 0.0; }
};

// The master's own step and the device, tick by tick. Deterministic.
class WallBench {
 public:
  // `scene` has walls and outlives the bench. With `recording` the middle of the recording's
  // bounding box goes to `middle`, frame of the walls; else the hand rests at M's origin.
  WallBench(const Scene& scene, const HandOptions& hand,
            std::optional<RecordedMotion> recording = std::nullopt,
            const Vec2& middle = Vec2::Zero());

  // The hand follows what is at `p` with velocity `v`, until the next call. Frame of the walls.
  void follow(const Vec2& p, const Vec2& v) noexcept;
  // The hand goes limp, until the next call of follow.
  void let_go() noexcept { joystick_.let_go(); }
  // One tick. Real-time safe.
  const WallTick& step() noexcept;
  const WallTick& now() const noexcept { return tick_; }

  double moving_mass() const noexcept { return hand_mass_ + device_mass_; }  // [kg]

 private:
  std::unique_ptr<WallRun> run_;
  EffectStack walls_alone_;
  SimJoystick joystick_;
  Pose2 pose_;  // of the walls in M
  double hand_mass_, device_mass_;
  Vec2 last_velocity_ = Vec2::Zero();  // frame M
  std::int64_t ticks_ = 0;
  WallTick tick_;
};

}  // namespace handrail
