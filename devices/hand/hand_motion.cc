#include "devices/hand/hand_motion.h"

#include <cmath>

#include "server/base/hand_move.h"

namespace handrail {
namespace {

constexpr double kRounding = 1e-9;  // of a limit that was asked for in other units

// Angular velocity of exp(phi) when phi changes by `rate`: the left Jacobian of SO(3) times rate.
Vec3 angular_velocity(const Vec3& phi, const Vec3& rate) noexcept {
  const double angle2 = phi.squaredNorm();
  const double angle = std::sqrt(angle2);
  const bool small = angle < 1e-4;
  const double a = small ? 0.5 - angle2 / 24.0 : (1.0 - std::cos(angle)) / angle2;
  const double b = small ? 1.0 / 6.0 : (angle - std::sin(angle)) / (angle2 * angle);
  const Vec3 cross = phi.cross(rate);
  return rate + a * cross + b * phi.cross(cross);
}

}  // namespace

void HandMotion::steer(const HandIntent& intent) noexcept {
  const double distance = intent.displacement_M.norm();
  const double angle = intent.rotation_M.norm();
  if (!(distance <= kFarthestHandMove + kRounding && angle <= kWidestHandTurn + kRounding)) return;
  if (!(intent.duration >= kShortestHandMove && intent.duration <= kLongestHandMove)) return;
  goal_p_ = intent.home ? home_ : Vec3(position_.p + intent.displacement_M);
  goal_q_ = intent.home ? Quat::Identity() : (rotation_exp(intent.rotation_M) * q_).normalized();
  goal_duration_ = intent.duration;
  goal_buttons_ = intent.buttons;
  if (!waiting_) wait_left_ = reaction_;
  waiting_ = true;
}

void HandMotion::step(double dt) noexcept {
  if (waiting_ && wait_left_ <= dt) {
    advance(wait_left_);
    dt -= wait_left_;
    start();
  } else if (waiting_) {
    wait_left_ -= dt;
  }
  advance(dt);
}

void HandMotion::advance(double dt) noexcept {
  if (!running_) return;
  elapsed_ += dt;
  position_ = translation_.at(elapsed_);
  const VectorMotion phi = rotation_.at(elapsed_);
  q_ = (rotation_exp(phi.p) * q_base_).normalized();
  omega_ = angular_velocity(phi.p, phi.v);
  // Leaves out the Jacobian's own rate: exact for a turn about one axis.
  alpha_ = angular_velocity(phi.p, phi.a);
  running_ = elapsed_ < translation_.duration();
}

void HandMotion::start() noexcept {
  translation_ = MinJerk(position_, goal_p_, goal_duration_);
  q_base_ = q_;
  rotation_ = MinJerk({Vec3::Zero(), omega_, alpha_}, rotation_log(goal_q_ * q_base_.conjugate()),
                      goal_duration_);
  buttons_ = goal_buttons_;
  elapsed_ = 0.0;
  running_ = true;
  waiting_ = false;
}

}  // namespace handrail
