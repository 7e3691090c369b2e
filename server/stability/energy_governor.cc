#include "server/stability/energy_governor.h"

#include <algorithm>
#include <cmath>

namespace handrail {
namespace {

// What the device takes of this way by itself [J].
double taken_by_device(const GovernorSettings& settings, double way, double dt) {
  // A clock that has leapt does not make the hand faster than it was.
  const double time = std::max(dt, settings.period);
  return way * (settings.friction + settings.damping * way / time);
}

// The part of `way` on which a spring that goes from `before` to `now` pushes: all of it, but where
// it begins or ends in between.
double pushed_part(const Vec3& before, const Vec3& now, double stiffness, double way) {
  const bool begins = before.isZero(0.0), ends = now.isZero(0.0);
  if (begins == ends || way == 0.0) return 1.0;
  return std::min((begins ? now : before).norm() / (stiffness * way), 1.0);
}

bool usable(const Vec3& moved, double dt, double most_way) {
  return is_finite(moved) && moved.squaredNorm() <= most_way * most_way && dt > 0.0 &&
         std::isfinite(dt);
}

// `force` made smaller by `less` [N], as far as it goes.
Governed reduced(const Vec3& force, double size, double less) {
  Governed out{force};
  if (!(less > 0.0)) return out;
  out.force *= std::max(1.0 - less / size, 0.0);
  out.acted = true;
  return out;
}

}  // namespace

Governed EnergyGovernor::govern(const GovernorSettings& settings, const RenderedForce& force,
                                const Vec3& moved, double dt) noexcept {
  const bool known = is_finite(force.wanted) && is_finite(force.springs) && force.stiffness > 0.0;
  Governed out{is_finite(force.wanted) ? force.wanted : Vec3(Vec3::Zero())};
  if (!settings.on || !known || !usable(moved, dt, settings.most_way)) {
    springs_ = known ? force.springs : Vec3(Vec3::Zero());
    out.made = made_;
    return out;
  }
  const double way = moved.norm(), size = force.wanted.norm();
  const double part = pushed_part(springs_, force.springs, force.stiffness, way);
  const double law = 0.5 * part * (springs_ + force.springs).dot(moved);
  made_ = std::max(made_ + told_.dot(moved) - law - taken_by_device(settings, way, dt), 0.0);
  springs_ = force.springs;
  // The next way is taken to be as this one was.
  const double along = size > 0.0 ? force.wanted.dot(moved) / size : 0.0;
  if (along > 0.0) {
    const double taken = taken_by_device(settings, along, dt) / along;
    const double left = made_ * force.stiffness / size;  // spread over size / stiffness
    out = reduced(force.wanted, size, 0.5 * force.stiffness * along + left - taken);
  }
  out.made = made_;
  return out;
}

Governed EnergyTank::govern(const GovernorSettings& settings, const Vec3& wanted, double stiffness,
                            const Vec3& moved, double dt) noexcept {
  const bool known = is_finite(wanted) && stiffness > 0.0;
  Governed out{is_finite(wanted) ? wanted : Vec3(Vec3::Zero())};
  if (!settings.on || !known || !usable(moved, dt, settings.most_way)) {
    if (!known || !usable(moved, dt, settings.most_way)) energy_ = 0.0;
    return out;
  }
  const double way = moved.norm(), size = wanted.norm();
  energy_ += taken_by_device(settings, way, dt) - told_.dot(moved);
  energy_ = std::min(energy_, 0.5 * size * size / stiffness);
  const double along = size > 0.0 ? wanted.dot(moved) / size : 0.0;
  if (along > 0.0) {
    const double taken = taken_by_device(settings, along, dt);
    const double most = std::max(energy_ + taken, 0.0) / along;
    out = reduced(wanted, size, size - most);
  }
  out.made = std::max(-energy_, 0.0);
  return out;
}

}  // namespace handrail
