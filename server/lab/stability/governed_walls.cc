#include "server/lab/stability/governed_walls.h"

#include <algorithm>

namespace handrail {

double GovernedWalls::stiffness() const noexcept {
  return run_->state.effects.stiffness() + run_->state.wall_stiffness;
}

Vec2 GovernedWalls::step(const HandReading& hand, double dt) noexcept {
  WallInput in;
  in.hand = hand;
  const Vec2 before = run_->state.velocity;
  wall_step(run_->settings, in, dt, run_->state, out_);
  if (!started_) last_ = hand.X_MH.p;
  started_ = true;
  const Vec3 force = governed(hand, dt);
  explained_ = 2.0 * stiffness() * (hand.X_MH.p - last_).norm();
  if (out_.contact.touching) {
    const WallRegion& wall = run_->settings.walls->regions[out_.contact.wall];
    explained_ += wall.damping * ((hand.v_MH.head<2>() - before).norm() + hand.v_MH.norm());
  }
  last_ = hand.X_MH.p;
  return force.head<2>();
}

// Until wall_step takes WallSettings::governor: what goes round it is the same, but for the limits
// of the device, which come before it here.
Vec3 GovernedWalls::governed(const HandReading& hand, double dt) noexcept {
  RenderedForce force;
  force.wanted = out_.f_H_M.force;
  force.stiffness = stiffness();
  const bool damped =
      out_.contact.touching && run_->settings.walls->regions[out_.contact.wall].damping > 0.0;
  const Vec2 springs = run_->state.turn *
                       (damped ? Vec2(run_->state.wall_stiffness * (out_.contact.proxy - out_.hand))
                               : out_.effects.force);
  force.springs.head<2>() = springs;
  const double size = springs.norm(), most = force.wanted.norm();
  if (size > most) force.springs *= most / size;
  const Governed out = governor_.govern(settings_, force, hand.X_MH.p - last_, dt);
  governor_.told(out.force);
  return out.force;
}

}  // namespace handrail
