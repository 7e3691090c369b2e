#include "devices/hand/hand_pursuit.h"

#include <cmath>

namespace handrail {

void HandPursuit::start(const VectorMotion& intent) noexcept {
  intent_ = intent;
  for (Vec3& lag : seen_) lag.setZero();
}

VectorMotion HandPursuit::step(const VectorMotion& target, const VectorMotion& hand,
                               double dt) noexcept {
  Vec3 wish = options_.gain * (target.p - hand.p + options_.lead * (target.v - hand.v));
  const double keep = std::exp(-3.0 * dt / options_.delay);
  for (Vec3& lag : seen_) {
    lag = wish + keep * (lag - wish);
    wish = lag;
  }
  const Vec3 wanted = target.v + wish;
  const Vec3 before = intent_.v;
  intent_.v = wanted + std::exp(-dt / options_.muscle) * (intent_.v - wanted);
  intent_.p += dt * intent_.v;
  const Vec3 ahead = intent_.p - hand.p;
  const double distance = ahead.norm();
  if (distance > options_.most_lead) {
    intent_.p = hand.p + (options_.most_lead / distance) * ahead;
    const Vec3 away = ahead / distance;
    const double outward = (intent_.v - hand.v).dot(away);
    if (outward > 0.0) intent_.v -= outward * away;
  }
  intent_.a = (intent_.v - before) / dt;
  return intent_;
}

}  // namespace handrail
