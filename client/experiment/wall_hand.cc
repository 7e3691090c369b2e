#include "client/experiment/wall_hand.h"

#include <algorithm>

#include "client/api/cursor_sender.h"

namespace handrail {
namespace {

Vec3 in_space(const Vec2& v) { return {v.x(), v.y(), 0.0}; }

VectorMotion flat(VectorMotion motion) {
  motion.p.z() = motion.v.z() = motion.a.z() = 0.0;
  return motion;
}

}  // namespace

WallHand::WallHand(const JoystickPerson& person, const Pose2& walls)
    : hand_(person.hand), walls_(walls), pace_(person.pace) {}

void WallHand::live(Nanos now, const WallTick& seen, const Vec2& p, const Vec2& v, bool lets_go) {
  lever_.p = in_space(walls_.to_world(seen.hand));
  lever_.v = in_space(Pose2::turned(seen.velocity, walls_.angle));
  VectorMotion target;
  target.p = in_space(walls_.to_world(p));
  target.v = in_space(Pose2::turned(v, walls_.angle));
  if (last_ < 0) last_ = now;
  Nanos left = std::min(now - last_, kLongestHandStep);
  last_ = now;
  if (lets_go || !follows_) {
    hand_.place(lever_.p);
    VectorMotion rest;
    rest.p = lever_.p;
    pursuit_.start(rest);
  }
  follows_ = !lets_go;
  if (lets_go) return;
  for (; left > 0; left -= kHandStep) {
    const double dt = to_seconds(std::min(left, kHandStep));
    hand_.lead(flat(pursuit_.step(target, lever_, dt)));
    // The device has the hand's compliance: here it only means.
    hand_.step(dt, Wrench{});
    target.p += dt * target.v;
    lever_.p += dt * lever_.v;
  }
}

Pose WallHand::pose() const {
  Pose out;
  out.p = follows_ ? hand_.pose().p : lever_.p;
  out.p.z() = 0.0;
  return out;
}

}  // namespace handrail
