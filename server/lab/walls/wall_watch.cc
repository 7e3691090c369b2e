#include "server/lab/walls/wall_watch.h"

#include <algorithm>
#include <cmath>

namespace handrail {
namespace {

double stiffness_at(const Walls& walls, const WallTick& tick) {
  return walls.regions[tick.contact.wall].stiffness;
}

}  // namespace

void PenetrationWatch::see(const WallTick& tick) noexcept {
  const Vec2 before = velocity_;
  velocity_ = tick.velocity;
  if (!tick.contact.touching) {
    touching_ = false;
    return;
  }
  const Vec2 into = -tick.contact.normal;
  if (!touching_) push_ = 0.0, speed_ = std::max(0.0, before.dot(into));
  touching_ = true;
  const double depth = tick.depth();
  const double stiffness = stiffness_at(*walls_, tick);
  const double others = std::max(0.0, (tick.device - tick.wall).dot(into));
  push_ = std::max(push_, tick.effort.dot(into) + others);
  speed_ = std::max(speed_, tick.velocity.dot(into));
  deepest_ = std::max(deepest_, depth);
  if (depth < kShallow) return;
  const double rest = push_ / stiffness;
  const double bound =
      rest + std::sqrt(rest * rest + mass_ * speed_ * speed_ / stiffness) + speed_ * kBenchTick;
  share_ = std::max(share_, depth / bound);
}

void JunctionWatch::see(const WallTick& tick) noexcept {
  const auto near = std::find_if(places_.begin(), places_.end(), [&](const Vec2& place) {
    return (tick.hand - place).squaredNorm() < reach_ * reach_;
  });
  const int at = near == places_.end() ? -1 : static_cast<int>(near - places_.begin());
  if (at != at_) {
    ratio_ = ratio();
    force_ = 0.0;
    local_ = 1e-9;
    at_ = at;
  }
  if (at >= 0 && tick.contact.touching) {
    force_ = std::max(force_, tick.wall.norm());
    local_ = std::max(local_, local_force(tick));
  }
  velocity_ = tick.velocity;
}

double JunctionWatch::local_force(const WallTick& tick) noexcept {
  const Vec2 out = nearest_->start(tick.hand) - tick.hand;
  // From far inside a wall the nearest point is not looked for.
  const double depth = std::min(out.norm(), tick.depth());
  const Vec2 into = depth > 0.0 ? Vec2(-out.normalized()) : Vec2(-tick.contact.normal);
  const double speed = std::max({0.0, tick.velocity.dot(into), velocity_.dot(into)});
  return stiffness_at(*walls_, tick) * (depth + kJoystickResolution) +
         walls_->regions[tick.contact.wall].damping * speed;
}

void RestWatch::see(const WallTick& tick) noexcept {
  constexpr double kWithin = 2e-3;  // [m]
  constexpr double kFor = 0.5;      // [s]
  if ((tick.hand - anchor_).squaredNorm() > kWithin * kWithin) {
    anchor_ = tick.hand;
    since_ = tick.t;
  }
  rests_ = tick.t - since_ >= kFor;
}

void GuidanceWatch::see(const WallTick& tick) noexcept {
  const double way = seen_ ? (tick.hand - last_).norm() : 0.0;
  last_ = tick.hand;
  seen_ = true;
  way_ += way;
  if (!tick.contact.touching) inside_ += way;
  most_force_ = std::max(most_force_, tick.handle.norm());
}

}  // namespace handrail
