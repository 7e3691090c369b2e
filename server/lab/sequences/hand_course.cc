#include "server/lab/sequences/hand_course.h"

namespace handrail {
namespace {

constexpr double kRoom = 0.15;         // of the hand about the origin [m]
constexpr double kVelocityLag = 5e-3;  // of the device's low-pass, chosen [s]
constexpr double kWanderTime = 0.03;   // in which a wandering hand takes on a speed [s]
constexpr double kTwitch = 30.0;       // of a jerking hand, a second

// Low speeds as often as high ones.
double speed_of(Draw& draw, double most) { return most * std::pow(draw.between(0.0, 1.0), 2.0); }

Vec3 no_faster(const Vec3& v, double most) {
  const double size = v.norm();
  return size > most ? Vec3(v * (most / size)) : v;
}

}  // namespace

HandCourse::HandCourse(Draw& draw) noexcept {
  reading_.valid = true;
  reading_.X_MH.p = draw.between(0.0, 0.05) * draw.unit();
  reading_.X_MH.q = rotation_exp(draw.between(0.0, 3.0) * draw.unit());
}

void HandCourse::begin(Draw& draw) noexcept {
  gait_ = static_cast<Gait>(draw.below(4));
  left_ = draw.between(0.02, 0.4);
  tremor_ = draw.between(8.0, 12.0);
  v_to_ = speed_of(draw, kFastestCourse) * draw.unit();
  w_to_ = speed_of(draw, kFastestTurning) * draw.unit();
}

void HandCourse::choose_speed(Draw& draw, double elapsed) noexcept {
  switch (gait_) {
    case Gait::kPause: v_ = w_ = Vec3::Zero(); break;
    case Gait::kWander: {
      const double share = std::min(elapsed / kWanderTime, 1.0);
      v_ += share * (v_to_ - v_);
      w_ += share * (w_to_ - w_);
      break;
    }
    case Gait::kJerk:
      if (draw.chance(kTwitch * elapsed)) v_to_ = speed_of(draw, kFastestCourse) * draw.unit();
      if (draw.chance(kTwitch * elapsed)) w_to_ = speed_of(draw, kFastestTurning) * draw.unit();
      v_ = v_to_;
      w_ = w_to_;
      break;
    case Gait::kTremor: {
      const double swing = std::sin(2.0 * std::numbers::pi * tremor_ * time_);
      v_ = swing * v_to_;
      w_ = swing * w_to_;
      break;
    }
  }
}

HandReading HandCourse::move(Draw& draw, double elapsed) noexcept {
  time_ += elapsed;
  left_ -= elapsed;
  if (left_ <= 0.0) begin(draw);
  choose_speed(draw, elapsed);
  Vec3& p = reading_.X_MH.p;
  if (p.norm() > kRoom && v_.dot(p) > 0.0) {
    const Vec3 out = p.normalized();
    v_ -= 2.0 * v_.dot(out) * out;
    v_to_ -= 2.0 * std::max(v_to_.dot(out), 0.0) * out;
  }
  v_ = no_faster(v_, kFastestCourse);
  w_ = no_faster(w_, kFastestTurning);
  p += elapsed * v_;
  if (!w_.isZero(0.0)) {
    reading_.X_MH.q = (rotation_exp(elapsed * w_) * reading_.X_MH.q).normalized();
  }
  reading_.v_MH += std::min(elapsed / kVelocityLag, 1.0) * (v_ - reading_.v_MH);
  return reading_;
}

}  // namespace handrail
