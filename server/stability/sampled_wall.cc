#include "server/stability/sampled_wall.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace handrail {
namespace {

using std::numbers::pi;

// The way that the device goes in `time` by itself, from a speed of 1 m/s.
double coast(const SampledWall& wall, double time) {
  const double x = wall.damping * time / wall.mass;
  return x > 0.0 ? -time * std::expm1(-x) / x : time;
}

// The way that it is pushed in `time`, from rest, by 1 N; its speed is then coast() / mass.
double pushed(const SampledWall& wall, double time) {
  const double x = wall.damping * time / wall.mass;
  const double unit = time * time / wall.mass;
  // A series where the closed form loses its digits: the next term is below 1e-14.
  if (x < 1e-3) return unit * (1.0 / 2 - x / 6 + x * x / 24 - x * x * x / 120);
  return unit * (x + std::expm1(-x)) / (x * x);
}

// How a force that is held for a period, and begins `late` into it, moves the device: by h F at its
// end, h_next F at the end of the next, and h_last F at that of the one after, beside its own
// motion, whose speed falls by e.
struct Held {
  double e, h, h_next, h_last;
};

Held hold(const SampledWall& wall) {
  const double begins = wall.late * wall.period, lasts = wall.period - begins;
  const double e = std::exp(-wall.damping * wall.period / wall.mass);
  const double coasts = coast(wall, wall.period);
  // The part in its own period, and the part in the next, which the device then coasts on from.
  const double way = pushed(wall, lasts), speed = coast(wall, lasts) / wall.mass;
  const double rest_speed = coast(wall, begins) / wall.mass;
  const double rest_way = pushed(wall, begins) + rest_speed * coast(wall, lasts);
  const double rest_end = rest_speed * std::exp(-wall.damping * lasts / wall.mass);
  return {e, way, coasts * speed - e * way + rest_way, coasts * rest_end - e * rest_way};
}

// Whether all roots lie inside the unit circle (Schur and Cohn): the polynomial is brought down a
// degree at a time. `a`: real, its highest power first.
bool all_inside(std::vector<double> a) {
  while (a.size() > 1) {
    const double share = a.back() / a.front();
    if (!(std::abs(share) < 1.0)) return false;
    const std::size_t degree = a.size() - 1;
    std::vector<double> next(degree);
    for (std::size_t i = 0; i < degree; ++i) next[i] = a[i] - share * a[degree - i];
    a = std::move(next);
  }
  return true;
}

// (z - 1) (z - e) (z - p) z^(d + 1) + (h z^2 + h_next z + h_last) (K (z - p) + G (z - 1)), G = B (1
// - p) / T: with p = 0 a factor z and the law (K + B/T) z - B/T.
std::vector<double> characteristic(const SampledWall& wall, double stiffness) {
  const Held held = hold(wall);
  const double p = wall.velocity_pole, gain = wall.wall_damping * (1.0 - p) / wall.period;
  const double now = stiffness + gain, past = stiffness * p + gain;
  std::vector<double> a(static_cast<std::size_t>(wall.delay) + 5, 0.0);
  a[0] = 1.0;
  a[1] = -(1.0 + held.e) - p;
  a[2] = held.e + p * (1.0 + held.e);
  a[3] = -p * held.e;
  const std::size_t last = a.size() - 1;
  a[last - 3] += held.h * now;
  a[last - 2] += held.h_next * now - held.h * past;
  a[last - 1] += held.h_last * now - held.h_next * past;
  a[last] -= held.h_last * past;
  return a;
}

}  // namespace

bool is_stable(const SampledWall& wall, double stiffness) {
  return all_inside(characteristic(wall, stiffness));
}

double stiffness_onset(const SampledWall& wall) {
  double stable = 1e-9 * wall.mass / (wall.period * wall.period);
  if (!is_stable(wall, stable)) return 0.0;
  // From below, so that it is the first. It ends: stiff enough, every sampled wall is unstable.
  double unstable = 1.1 * stable;
  for (; is_stable(wall, unstable); unstable *= 1.1) stable = unstable;
  while (unstable - stable > 1e-9 * unstable) {
    const double middle = 0.5 * (stable + unstable);
    (is_stable(wall, middle) ? stable : unstable) = middle;
  }
  return unstable;
}

double passive_damping(const SampledWall& wall, double stiffness) noexcept {
  const int delay = wall.delay + (wall.late > 0.0 ? 1 : 0);
  const double late = 2.0 * delay + 1.0;
  const auto at = [&](double angle) {
    return 0.5 * stiffness * wall.period * std::sin(0.5 * late * angle) / std::sin(0.5 * angle) -
           wall.wall_damping * std::cos((delay + 1.0) * angle);
  };
  // Its waves are no shorter than 2 pi / (delay + 1): of a hundred points a wave the highest is
  // within a thousandth of the wave's height, and a parabola through it and its neighbours far
  // nearer.
  const int points = 100 * (delay + 1);
  double most = 0.5 * stiffness * wall.period * late - wall.wall_damping;  // at angle 0
  for (int i = 1; i <= points; ++i) {
    const double step = pi / points, angle = i * step;
    const double here = at(angle);
    most = std::max(most, here);
    const double before = at(angle - 0.5 * step), behind = at(std::min(angle + 0.5 * step, pi));
    const double bend = before - 2.0 * here + behind;
    if (here >= before && here >= behind && bend < 0.0) {
      const double slope = 0.5 * (behind - before);
      most = std::max(most, here - 0.5 * slope * slope / bend);
    }
  }
  return std::max(most, 0.0);
}

double energy_per_cycle(double stiffness, double amplitude, double frequency, double period,
                        double delay) noexcept {
  const double w = 2.0 * pi * frequency, half = 0.5 * w * period;
  const double held = half == 0.0 ? 1.0 : std::sin(half) / half;
  return pi * stiffness * amplitude * amplitude * std::sin(half + w * delay) * held;
}

std::optional<double> speed_that_grows(const SampledWall& wall, double stiffness,
                                       double friction) noexcept {
  const double made = stiffness * wall.period * (0.5 + wall.delay + wall.late) - wall.damping;
  if (!(made > 0.0)) return std::nullopt;
  return 4.0 / pi * friction / made;
}

}  // namespace handrail
