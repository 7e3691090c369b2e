#include "server/stability/energy_governor.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace handrail {
namespace {

// The part of `way` on which a spring that goes from `before` to `now` pushes: all of it, but where
// it begins or ends in between.
double pushed_part(const Vec3& before, const Vec3& now, double stiffness, double way) {
  const bool begins = before.isZero(0.0), ends = now.isZero(0.0);
  if (begins == ends || way == 0.0) return 1.0;
  const double on_way = (begins ? now : before).norm();
  return on_way < stiffness * way ? on_way / (stiffness * way) : 1.0;
}

Vec3 no_larger(const Vec3& force, double most) {
  const double size = force.norm();
  return size > most ? Vec3(force * (most / size)) : force;
}

bool usable(const Vec3& moved, double dt, double most_way) {
  return is_finite(moved) && moved.squaredNorm() <= most_way * most_way && dt > 0.0 &&
         std::isfinite(dt);
}

// As the hand presses in, a bounded force comes back by this many times what the spring adds on the
// same way. With 1 it would never catch up. Chosen; with 4 the suite shows the same within 1 %.
constexpr double kReturn = 2.0;

// Makes the force smaller, so that it pushes the way the hand goes by `less` [N] less than by
// `push` [N]. Its direction stays: what is taken from a slanted one along that way alone would push
// the hand to the side.
void reduce(Governed& out, double push, double less) {
  if (!(less > 0.0)) return;
  out.force *= 1.0 - std::min(less, push) / push;
  out.acted = true;
}

}  // namespace

double HandWay::add(const GovernorSettings& settings, const Vec3& moved, double dt,
                    double used) noexcept {
  // A clock that has leapt does not make the hand faster than it was.
  still_ += std::max(dt, settings.period);
  if (moved.isZero(0.0)) return 0.0;
  const double way = along_.isZero(0.0) ? moved.norm() : std::abs(along_.dot(moved));
  const double time = std::exchange(still_, 0.0);
  way_ = kKept * way_ + moved;
  if (const double size = way_.norm(); size > 0.0) along_ = way_ / size;
  last_ = std::abs(along_.dot(moved));
  const auto left = [&](double on_way) {
    const double taken = on_way * (settings.friction + settings.damping * on_way / time);
    return std::max(taken - used, 0.0);
  };
  taken_ = left(last_);
  return left(way);
}

void ToldForces::add(const Vec3& force) noexcept {
  newest_ = (newest_ + 1) % told_.size();
  told_[newest_] = is_finite(force) ? force : Vec3(Vec3::Zero());
}

const Vec3& ToldForces::acting(int delay) const noexcept {
  const auto back = static_cast<std::size_t>(std::clamp(delay, 0, kMostForceDelay));
  return told_[(newest_ + told_.size() - back) % told_.size()];
}

Vec3 ToldForces::acting(const GovernorSettings& settings, bool missed) const noexcept {
  const double late = missed ? 1.0 : std::clamp(settings.late, 0.0, 1.0);
  const Vec3& newest = acting(settings.delay);
  if (late == 0.0) return newest;
  return newest + late * (acting(settings.delay + 1) - newest);
}

void EnergyGovernor::told(const Vec3& force) noexcept {
  told_.add(force);
  const double size = told_.acting(0).norm();
  limit_ = size < asked_ ? size : kNoForceLimit;
}

Governed EnergyGovernor::govern(const GovernorSettings& settings, const RenderedForce& force,
                                const Vec3& moved, double dt, bool missed) noexcept {
  const bool known = is_finite(force.wanted) && is_finite(force.springs) && force.stiffness >= 0.0;
  Governed out{is_finite(force.wanted) ? force.wanted : Vec3(Vec3::Zero())};
  const Vec3 springs =
      known ? no_larger(force.springs, std::min(settings.peak, limit_)) : Vec3(Vec3::Zero());
  const Vec3 before = std::exchange(springs_, springs);
  out.made = made_;
  asked_ = out.force.norm();
  if (!settings.on || !known || !usable(moved, dt, settings.most_way)) return out;
  const double way = moved.norm(), size = asked_;
  if (force.stiffness > 0.0) stiffness_ = force.stiffness;
  const double law =
      0.5 * pushed_part(before, springs, stiffness_, way) * (before + springs).dot(moved);
  const double taken = hand_.add(settings, moved, dt);
  const double made = made_ + told_.acting(settings, missed).dot(moved) - law;
  out.used = std::clamp(made, 0.0, taken);
  made_ = std::max(made - taken, 0.0);
  // The next way is taken to be as this one was, and those after it until what is told now acts.
  const double push = way > 0.0 ? force.wanted.dot(moved) / way : 0.0;
  if (push > 0.0 && force.stiffness > 0.0) {
    const double left = made_ * force.stiffness / size;  // spread over size / stiffness
    // A wall's spring changes with the part of the way along its force alone.
    const double along = push / size;
    const double makes =
        (0.5 + settings.delay + settings.late) * force.stiffness * way * along * along;
    reduce(out, push, makes + left - taken / way);
    asked_ = out.force.norm();
  }
  out.made = made_;
  return out;
}

Governed EnergyTank::govern(const GovernorSettings& settings, const Vec3& wanted, double stiffness,
                            const Vec3& moved, double dt, bool missed, double used) noexcept {
  const bool known = is_finite(wanted) && stiffness > 0.0;
  Governed out{is_finite(wanted) ? wanted : Vec3(Vec3::Zero())};
  if (!settings.on || !known || !usable(moved, dt, settings.most_way)) {
    if (!known || !usable(moved, dt, settings.most_way)) energy_ = 0.0;
    return out;
  }
  const double size = wanted.norm(), had = energy_;
  energy_ += hand_.add(settings, moved, dt, used) - told_.acting(settings, missed).dot(moved);
  // What was put in stays in a spring that is cut off. What the device takes of a hand that meets
  // no spring is not put in.
  if (size == 0.0) {
    energy_ = std::min(energy_, had);
    return out;
  }
  energy_ = std::min(energy_, 0.5 * size * size / stiffness);
  const double push = wanted.dot(hand_.along()), way = hand_.last();
  // What was bounded comes back as the hand presses in, and no faster than twice the spring.
  limit_ += kReturn * stiffness * std::max(-wanted.dot(moved) / size, 0.0);
  if (push > 0.0 && way > 0.0) {
    // No more than is there on this way, and beside what the device takes no more than a spring
    // pushes that holds it: so the force sinks as the energy does, not all at once at its end.
    const double there = std::max(energy_ + hand_.taken(), 0.0) / way;
    const double spring = std::sqrt(2.0 * stiffness * std::max(energy_, 0.0)) + hand_.taken() / way;
    limit_ = std::min(limit_, std::min(there, spring) * size / push);
  }
  out.acted = size > limit_;
  if (out.acted) out.force *= limit_ / size;
  if (!out.acted) limit_ = kNoForceLimit;
  out.made = std::max(-energy_, 0.0);
  return out;
}

}  // namespace handrail
