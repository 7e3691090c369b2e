#include "server/lab/stability/sampled_loop.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace handrail {
namespace {

// Without friction a device is exact at any step.
double inner_step(const SampledWall& wall, double friction) {
  return friction > 0.0 ? 0.05 * wall.period : wall.period;
}

// Of the wall as if it were not sampled [ticks].
int ticks_a_swing(const SampledWall& wall, double stiffness) {
  const double ticks = 2.0 * std::numbers::pi * std::sqrt(wall.mass / stiffness) / wall.period;
  return std::max(2, static_cast<int>(ticks));
}

// Kicked by `speed`, whether it comes to half as much again before it comes to half.
bool grows_from(const SampledWall& wall, double stiffness, double friction, double speed) {
  constexpr int kMostSwings = 400;
  constexpr double kFar = 0.5;
  SampledLoop loop(wall, stiffness, friction);
  loop.kick(speed);
  const int swing = ticks_a_swing(wall, stiffness);
  double last = speed;
  for (int i = 0; i < kMostSwings; ++i) {
    double most = 0.0;
    for (int t = 0; t < swing; ++t) {
      loop.tick();
      most = std::max(most, std::abs(loop.speed()));
    }
    if (i > 0 && most > (1.0 + kFar) * speed) return true;
    if (most < (1.0 - kFar) * speed) return false;
    last = most;
  }
  return last > speed;
}

}  // namespace

SampledLoop::SampledLoop(const SampledWall& wall, double stiffness, double friction)
    : wall_(wall),
      stiffness_(stiffness),
      device_({wall.mass, wall.damping, friction}, {}, Vec2::Zero(), inner_step(wall, friction)),
      forces_(static_cast<std::size_t>(wall.delay) + 1, 0.0) {}

void SampledLoop::tick() {
  const double x = position();
  forces_.push_back(-stiffness_ * x - wall_.wall_damping * (x - last_) / wall_.period);
  last_ = x;
  if (wall_.late > 0.0) device_.advance(wall_.late * wall_.period, {forces_.front(), 0.0});
  forces_.pop_front();
  device_.advance((1.0 - wall_.late) * wall_.period, {forces_.front(), 0.0});
}

double growth_of(const std::function<double()>& next, int swing, int settle, double period) {
  // The mean square over so many swings does not depend on where they begin, to 0.2 %.
  constexpr int kSwings = 50, kBefore = 20, kLeastTicks = 2000;
  constexpr double kEndless = 1e60;  // no need to see more
  settle = std::max(settle, kBefore * swing);
  const int window = std::max(kSwings * swing, kLeastTicks);
  double sums[2] = {0.0, 0.0};
  for (int i = 0; i < settle + 2 * window; ++i) {
    const double x = next();
    if (!(std::abs(x) < kEndless)) return std::log(kEndless) / (i * period);
    if (i >= settle) sums[i >= settle + window] += x * x;
  }
  return 0.5 * std::log(sums[1] / sums[0]) / (window * period);
}

double growth_rate(const SampledWall& wall, double stiffness) {
  constexpr int kSettle = 2000, kSettlePerDelay = 10;  // [ticks]
  SampledLoop loop(wall, stiffness);
  loop.kick(1.0);
  const auto next = [&loop] {
    loop.tick();
    return loop.position();
  };
  return growth_of(next, ticks_a_swing(wall, stiffness), kSettle + kSettlePerDelay * wall.delay,
                   wall.period);
}

double measured_onset(const SampledWall& wall, double near, double within) {
  constexpr int kTries = 4;
  double low = near * (1.0 - within), high = near * (1.0 + within);
  double dies = growth_rate(wall, low), grows = growth_rate(wall, high);
  if (dies >= 0.0) return low;
  if (grows <= 0.0) return high;
  double at = near;
  for (int i = 0; i < kTries; ++i) {
    at = low + (high - low) * dies / (dies - grows);
    const double rate = growth_rate(wall, at);
    (rate < 0.0 ? low : high) = at;
    (rate < 0.0 ? dies : grows) = rate;
  }
  return at;
}

double measured_speed_that_grows(const SampledWall& wall, double stiffness, double friction,
                                 double near) {
  constexpr double kSought = 4.0, kTo = 0.005;
  double dies = near / kSought, grows = near * kSought;
  while (grows - dies > kTo * dies) {
    const double middle = 0.5 * (dies + grows);
    (grows_from(wall, stiffness, friction, middle) ? grows : dies) = middle;
  }
  return 0.5 * (dies + grows);
}

}  // namespace handrail
