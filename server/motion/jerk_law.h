// Stopping and steering one axis within speed, acceleration and jerk, exactly at the cycles'
// instants. All lengths, speeds and changes are in units of the controller's cycle: a step v is
// what the axis moves in one cycle, a change a is by how much the step grew. Real-time safe
// throughout.
#pragma once

#include <algorithm>
#include <cmath>

namespace handrail {

// Limits of one axis. All > 0, jerk at most 4 times the acceleration: more never binds.
struct AxisLimits {
  double speed = 1.0;
  double acceleration = 1.0;
  double jerk = 1.0;
};

// Where one axis stands: last command, last step, last change of step.
struct AxisState {
  double x = 0.0;
  double v = 0.0;
  double a = 0.0;
};

// What y > 0 and the changes after it, each smaller by the jerk j, add up to:
// y + (y - j) + (y - 2j) + ... while positive.
inline double ramp(double y, double j) noexcept {
  if (!(y > 0.0)) return 0.0;
  const double n = std::floor(y / j);
  return (n + 1.0) * y - 0.5 * j * n * (n + 1.0);
}

// The y whose ramp is v.
inline double ramp_inverse(double v, double j) noexcept {
  if (!(v > 0.0)) return 0.0;
  const double n = std::floor(0.5 * (std::sqrt(1.0 + 8.0 * v / j) - 1.0));
  return (v + 0.5 * j * n * (n + 1.0)) / (n + 1.0);
}

// Change of step that brings the axis to rest soonest, landing exactly on v = 0, a = 0: on the
// curve a = -y with ramp(y) = v the next ramp is v - y, so the next y is smaller by the jerk.
inline double stop_change(const AxisLimits& limits, double v, double a) noexcept {
  const double y = std::min(ramp_inverse(std::abs(v), limits.jerk), limits.acceleration);
  return std::clamp(v > 0.0 ? -y : y, std::max(a - limits.jerk, -limits.acceleration),
                    std::min(a + limits.jerk, limits.acceleration));
}

// By so much of a full change stop_reach is too large at most: 1/8 by its own rounding, the rest by
// the sums', for acceleration/jerk of 0.25 to 12.5 cycles.
inline constexpr double kStopReachOver = 0.135;

// Upper bound of how far the axis goes on in the positive direction when stop_change acts from
// (v, a); mirror both signs for the other direction. From continuous time; sums over cycles are
// shorter by v/2 but for their rounding, at most acceleration/8. Never short for acceleration/jerk
// of 0.25 to 12.5 cycles.
inline double stop_reach(const AxisLimits& limits, double v, double a) noexcept {
  const double A = limits.acceleration, j = limits.jerk;
  if (a <= 0.0 && v <= 0.0) return 0.0;
  const double t = a / j;
  const double w = v + 0.5 * std::abs(a) * t;  // speed once the acceleration is shed, or before it
  double reach = 0.0;
  if (a <= 0.0 && w < 0.0) {  // brakes more than needed
    reach = v * std::sqrt(2.0 * v / j) / 3.0;
  } else {
    const double top = v + 0.5 * a * t;  // where all changes are braking
    if (top <= 0.0) return 0.0;
    const double from_top =
        top * j >= A * A ? 0.5 * top * (top / A + A / j) : top * std::sqrt(top / j);
    reach = from_top + v * t + j * t * t * t / 3.0;
  }
  return std::max(0.0, reach - std::max(0.0, 0.5 * v - 0.125 * A));
}

// More than stop_reach either way for less work, by what the axis steps at most on its way to rest:
// |v| + a^2 / 2 jerk.
inline double stop_reach_at_most(const AxisLimits& limits, double fastest) noexcept {
  const double in_cycles =
      0.5 * fastest / limits.acceleration + 1.5 * limits.acceleration / limits.jerk + 1.0;
  return fastest * in_cycles;
}

// Largest |step| the axis passes through when stop_change acts from (v, a). Exact.
inline double stop_peak(const AxisLimits& limits, double v, double a) noexcept {
  const double more = ramp(std::abs(a) - limits.jerk, limits.jerk);
  return std::max(std::abs(v), a > 0.0 ? v + more : more - v);
}

// The largest change of step upward within speed, acceleration and jerk; faster than the limit it
// slows to it. Mirror both signs for the other direction.
inline double fastest_change(const AxisLimits& limits, double v, double a) noexcept {
  double high = std::min(a + limits.jerk, limits.acceleration);
  const double faster = limits.speed - v;
  if (faster < 0.0) {
    high = std::min(high, stop_change(limits, -faster, a));
  } else if (high > 0.0) {
    high = std::min(high, ramp_inverse(faster, limits.jerk));
  }
  return std::max(high, a - limits.jerk);
}

// Change of step toward `target`: the largest whose stop is not beyond it and whose speed stays
// within the limit, so that the axis never passes the target even if nothing is ever asked again;
// an axis that must pass it stops. Faster than the limit it slows to it. Bounded work.
inline double track_change(const AxisLimits& limits, const AxisState& s, double target) noexcept {
  const double side = target >= s.x ? 1.0 : -1.0;
  const double room = side * (target - s.x), v = side * s.v, a = side * s.a;
  const double brake = stop_change(limits, v, a);
  const auto left = [&](double change) {
    const double next = v + change;
    return room - next - stop_reach(limits, next, change);
  };
  double high = std::max(fastest_change(limits, v, a), brake);
  double beyond = left(high);
  if (beyond >= 0.0) return side * high;
  double low = brake, within = left(low);
  if (within < 0.0) return side * brake;
  // False position, kept off the ends: what is left falls steadily with the change.
  constexpr int kSteps = 8;
  for (int i = 0; i < kSteps; ++i) {
    const double share = std::clamp(within / (within - beyond), 0.05, 0.95);
    const double change = low + share * (high - low);
    const double now = left(change);
    (now >= 0.0 ? low : high) = change;
    (now >= 0.0 ? within : beyond) = now;
  }
  return side * low;
}

}  // namespace handrail
