// What a simulated hand means to do: minimum-jerk moves, each after a reaction delay.
#pragma once

#include <cstdint>

#include "devices/hand/min_jerk.h"
#include "devices/haptic_device.h"
#include "server/base/spatial.h"

namespace handrail {

// The intended pose over time, frame M, starting at rest in M's origin. Pure; real-time safe.
class HandMotion {
 public:
  // `reaction`: from an order to the start of its move, >= 0 [s].
  explicit HandMotion(double reaction) noexcept : reaction_(reaction) {}

  // Where the hand begins and `intent.home` leads, not turned; finite [m].
  void set_home(const Vec3& p) noexcept { home_ = p; }

  // Orders a move whose goal lies `intent.displacement_M` and `intent.rotation_M` from where the
  // intended pose stands now, or is home. It begins after the reaction delay, from where the
  // intended pose then stands and with its velocity and acceleration, so a running move bends into
  // it smoothly. An order that finds another one waiting takes its place and its start. Rotations
  // go the shorter way round. Ignored: not finite, or beyond the limits of hand_move.h.
  void steer(const HandIntent& intent) noexcept;

  // The intent is where `motion` says, from outside, until the next order. Finite.
  void lead(const VectorMotion& motion) noexcept {
    position_ = motion;
    running_ = waiting_ = false;
  }

  // True from an order until its move has ended.
  bool moving() const noexcept { return waiting_ || running_; }

  // Advances by dt > 0 [s].
  void step(double dt) noexcept;

  const VectorMotion& position() const noexcept { return position_; }  // [m, m/s, m/s^2]
  const Quat& orientation() const noexcept { return q_; }
  std::uint32_t buttons() const noexcept { return running_ ? buttons_ : 0; }

 private:
  void advance(double dt) noexcept;
  void start() noexcept;

  double reaction_;
  Vec3 home_ = Vec3::Zero();
  VectorMotion position_;
  Quat q_ = Quat::Identity();
  Vec3 omega_ = Vec3::Zero();  // angular velocity, frame M [rad/s]
  Vec3 alpha_ = Vec3::Zero();  // angular acceleration [rad/s^2]

  bool running_ = false;
  double elapsed_ = 0.0;
  MinJerk translation_;
  MinJerk rotation_;  // rotation vector away from q_base_
  Quat q_base_ = Quat::Identity();
  std::uint32_t buttons_ = 0;

  bool waiting_ = false;
  double wait_left_ = 0.0;
  Vec3 goal_p_ = Vec3::Zero();
  Quat goal_q_ = Quat::Identity();
  double goal_duration_ = 1.0;
  std::uint32_t goal_buttons_ = 0;
};

}  // namespace handrail
