#include "server/lab/faults/audit/controller_audit.h"

#include <algorithm>
#include <cmath>

namespace handrail {
namespace {

constexpr double kArithmetic = 1e-9;  // of a limit: rounding of this file's own numbers
// Half the distance of neighbouring float32 numbers, of their size: targets come as such.
constexpr double kFloat32 = 0x1p-24;

// A divided difference and the most that rounding of its values makes of it.
struct Difference {
  double value = 0.0, rounding = 0.0;
};

Difference divided(const Difference& newer, const Difference& older, double span) {
  return {(newer.value - older.value) / span, (newer.rounding + older.rounding) / span};
}

double share(const Difference& d, double limit) {
  return std::max(std::abs(d.value) - d.rounding, 0.0) / limit;
}

}  // namespace

double TargetVerdict::worst() const noexcept { return std::max({step, speed, acceleration, jerk}); }

bool TargetVerdict::fine() const noexcept { return worst() <= 1.0 + kArithmetic; }

void TargetVerdict::raise_to(const TargetVerdict& other) noexcept {
  if (other.worst() > worst()) {
    joint = other.joint;
    from_rest = other.from_rest;
  }
  step = std::max(step, other.step);
  speed = std::max(speed, other.speed);
  acceleration = std::max(acceleration, other.acceleration);
  jerk = std::max(jerk, other.jerk);
}

ControllerAudit::ControllerAudit(const JointLimits& limits, Nanos period) noexcept
    : limits_(limits), period_(period) {
  const auto to_brake = limits.max_speed.array() / limits.max_acceleration.array();
  const auto to_turn = limits.max_acceleration.array() / limits.max_jerk.array();
  longest_stop_ = from_seconds((to_brake + 2.0 * to_turn).maxCoeff());
}

void ControllerAudit::place(const JointVector& q) noexcept {
  rest_ = best();
  rest_.open = true;
  readings_ = {};
  points_ = rest_until(-period_, q);
  placed_ = standing_ = true;
}

TargetVerdict ControllerAudit::accepted(Nanos at, const JointVector& q, int lost) noexcept {
  if (!placed_) place(q);
  until(at);
  ++targets_;
  const Nanos gap = at - points_[0].at;
  const bool held = standing_ || 2 * gap > 3 * period_;
  // A target that is held already moves nothing: the hold goes on.
  if (q == points_[0].q) return {};

  // Every reading, gone on by this target; the last choice is a start from rest.
  std::array<Reading, kKnown + 1> choice{};
  std::array<TargetVerdict, kKnown + 1> verdict{};
  const Point next{at, q};
  for (std::size_t i = 0; i < kKnown; ++i) {
    choice[i] = readings_[i];
    if (choice[i].open) verdict[i] = go_on(next, static_cast<int>(i) + 1, choice[i]);
  }
  if (held) {
    choice[kKnown] = at_rest();
    const auto cycles = static_cast<int>((gap + period_ / 2) / period_);
    choice[kKnown].rest_until = at - period_;
    choice[kKnown].rest_from = at - std::max(std::min(cycles, lost + 1), 1) * period_;
    verdict[kKnown] = go_on(next, 0, choice[kKnown]);
    verdict[kKnown].from_rest = true;
  }
  // The kindest reading counts, and the least bad one when none is left.
  std::size_t chosen = 0;
  const auto better = [&](std::size_t i, std::size_t than) {
    if (!choice[i].open || !choice[than].open) return choice[i].open;
    if (verdict[i].fine() != verdict[than].fine()) return verdict[i].fine();
    if (verdict[i].fine() && choice[i].halts != choice[than].halts) {
      return choice[i].halts < choice[than].halts;
    }
    return verdict[i].worst() < verdict[than].worst();
  };
  for (std::size_t i = 1; i < choice.size(); ++i) {
    if (better(i, chosen)) chosen = i;
  }
  for (std::size_t i = 0; i < choice.size(); ++i) {
    choice[i].open = choice[i].open && (verdict[i].fine() || i == chosen);
  }

  if (moving()) {
    held_ += static_cast<std::uint64_t>(std::max<Nanos>((gap + period_ / 2) / period_ - 1, 0));
  }
  readings_ = {choice[kKnown], choice[0], kinder(choice[1], choice[2])};
  standing_ = false;
  points_ = {next, points_[0], points_[1]};
  const TargetVerdict& found = verdict[chosen];
  if (!found.fine()) ++breaches_;
  worst_.raise_to(found);
  return found;
}

void ControllerAudit::came_late() noexcept {
  if (standing_) return;
  for (Point& point : points_) point.at += period_;
  for (Reading& reading : readings_) {
    reading.rest_until += period_;
    reading.rest_from += period_;
  }
}

void ControllerAudit::until(Nanos now) noexcept {
  if (placed_ && !standing_ && now - points_[0].at > longest_stop_) settle(now);
}

void ControllerAudit::settle(Nanos now) noexcept {
  if (moving()) held_ += static_cast<std::uint64_t>((now - points_[0].at) / period_);
  rest_ = at_rest();
  readings_ = {};
  standing_ = true;
}

// Standing still where the newest target is would be a halt.
bool ControllerAudit::moving() const noexcept {
  return !standing_ && at_rest().halts > best().halts;
}

std::uint64_t ControllerAudit::halts() const noexcept { return best().halts; }
double ControllerAudit::hardest_halt() const noexcept { return best().hardest; }

const ControllerAudit::Reading& ControllerAudit::kinder(const Reading& a,
                                                        const Reading& b) noexcept {
  if (!a.open || !b.open) return a.open ? a : b;
  if (a.halts != b.halts) return a.halts < b.halts ? a : b;
  return a.hardest <= b.hardest ? a : b;
}

ControllerAudit::Reading ControllerAudit::best() const noexcept {
  Reading kindest = standing_ ? rest_ : Reading();
  for (const Reading& reading : readings_) kindest = kinder(kindest, reading);
  return kindest;
}

// The arm stood at `q` until `at`.
ControllerAudit::History ControllerAudit::rest_until(Nanos at,
                                                     const JointVector& q) const noexcept {
  return {Point{at, q}, Point{at - period_, q}, Point{at - 2 * period_, q}};
}

// The targets before the next, if the arm stood until `rest` before the newest `since` of them.
ControllerAudit::History ControllerAudit::history(int since, Nanos rest) const noexcept {
  History out = points_;
  const auto known = static_cast<std::size_t>(since);
  if (known >= kKnown) return out;
  const History before = rest_until(rest, points_[known].q);
  std::copy_n(before.begin(), kKnown - known, out.begin() + since);
  return out;
}

// The next target as `reading` understands it, by which the newest `since` targets are of one
// motion. Of the times at which that may have begun those stay that make it sound, or the least bad
// one.
TargetVerdict ControllerAudit::go_on(const Point& next, int since,
                                     Reading& reading) const noexcept {
  const Nanos earliest = reading.rest_from;
  reading.rest_from = reading.rest_until;
  TargetVerdict best = judge(next, history(since, reading.rest_until));
  for (Nanos rest = reading.rest_until - period_; rest >= earliest; rest -= period_) {
    const TargetVerdict verdict = judge(next, history(since, rest));
    if (best.fine() && verdict.fine()) reading.rest_from = rest;
    if (best.fine() || verdict.worst() >= best.worst()) continue;
    best = verdict;
    reading.rest_until = reading.rest_from = rest;
  }
  return best;
}

TargetVerdict ControllerAudit::judge(const Point& next, const History& before) const noexcept {
  const std::array<Point, kKnown + 1> p{next, before[0], before[1], before[2]};
  const auto span = [&p](std::size_t i, std::size_t j) { return to_seconds(p[i].at - p[j].at); };
  TargetVerdict out;
  double largest = -1.0;
  for (int k = 0; k < kJoints; ++k) {
    std::array<Difference, kKnown + 1> d;
    for (std::size_t i = 0; i < p.size(); ++i) d[i] = {p[i].q[k], kFloat32 * std::abs(p[i].q[k])};
    const Difference step{d[0].value - d[1].value, d[0].rounding + d[1].rounding};
    std::array<double, 4> shares{share(step, limits_.max_speed[k] * to_seconds(period_))};
    const std::array<double, 3> limit{limits_.max_speed[k], limits_.max_acceleration[k],
                                      limits_.max_jerk[k]};
    // The n-th divided difference is the n-th derivative somewhere between, by n factorial.
    double factorial = 1.0;
    for (std::size_t n = 1; n <= kKnown; ++n) {
      for (std::size_t i = 0; i + n < p.size(); ++i) d[i] = divided(d[i], d[i + 1], span(i, i + n));
      factorial *= static_cast<double>(n);
      shares[n] = share(d[0], limit[n - 1] / factorial);
    }
    out.step = std::max(out.step, shares[0]);
    out.speed = std::max(out.speed, shares[1]);
    out.acceleration = std::max(out.acceleration, shares[2]);
    out.jerk = std::max(out.jerk, shares[3]);
    const double most = *std::max_element(shares.begin(), shares.end());
    if (most > largest) out.joint = static_cast<std::int8_t>(k);
    largest = std::max(largest, most);
  }
  return out;
}

// The motion of `reading` was over with the newest target: from the next cycle on the arm stands.
ControllerAudit::Reading ControllerAudit::ended(std::size_t reading) const noexcept {
  const Point first{points_[0].at + period_, points_[0].q};
  const Point second{first.at + period_, first.q};
  const int since = static_cast<int>(reading) + 1;
  Reading out = readings_[reading];
  const TargetVerdict stop = go_on(first, since, out);
  const History h = history(since, out.rest_until);
  const TargetVerdict stand = judge(second, {first, h[0], h[1]});
  if (stop.fine() && stand.fine()) return out;
  ++out.halts;
  out.hardest = std::max(out.hardest, stop.acceleration);
  return out;
}

ControllerAudit::Reading ControllerAudit::at_rest() const noexcept {
  if (standing_) return rest_;
  Reading kindest;
  for (std::size_t i = 0; i < kKnown; ++i) {
    if (readings_[i].open) kindest = kinder(kindest, ended(i));
  }
  return kindest;
}

}  // namespace handrail
