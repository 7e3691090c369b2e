// Whether the simulation shows what is known of a plain sampled spring. The numbers of tables E and
// F below are of other programs.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "server/lab/stability/sampled_loop.h"
#include "server/lab/stability/stability_case.h"

namespace handrail {
namespace {

using std::numbers::pi;

constexpr double kOnsetWithin = 0.02, kCycleWithin = 0.01, kSpeedWithin = 0.15;

double off(double measured, double expected) { return std::abs(measured / expected - 1.0); }

// The onset where growth begins; where there is none, that every stiffness grows.
CaseFigures onset(const SampledWall& wall) {
  const double expected = stiffness_onset(wall);
  if (expected > 0.0) {
    const double measured = measured_onset(wall, expected, 1.5 * kOnsetWithin);
    return {judged("off", off(measured, expected), kOnsetWithin), told("measured_n_m", measured),
            told("expected_n_m", expected)};
  }
  double least = std::numeric_limits<double>::infinity();
  const double unit = wall.mass / (wall.period * wall.period);
  for (const double share : {1e-6, 1e-5, 1e-4, 1e-3}) {
    least = std::min(least, growth_rate(wall, share * unit));
  }
  return {judged("least_rate_negative", -least, 0.0), told("expected_n_m", 0.0)};
}

void add_onsets(std::vector<StabilityCase>& out) {
  const auto add = [&out](const std::string& name, const SampledWall& wall) {
    out.push_back({"onset/" + name, true, false, [wall](std::uint64_t) { return onset(wall); }});
  };
  for (const int delay : {0, 1, 2, 10, 50}) {
    for (const double damping : {0.05, 0.1, 0.5, 1.0, 2.0, 5.0}) {
      add(fmt::format("plain/d{}/b{:g}", delay, damping),
          {.mass = 0.1, .damping = damping, .delay = delay});
    }
  }
  for (const int delay : {0, 1, 10}) {
    for (const double damping : {0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0}) {
      add(fmt::format("damped/d{}/B{:g}", delay, damping),
          {.mass = 0.1, .damping = 0.1, .wall_damping = damping, .delay = delay});
    }
  }
  // Mass and period of 1: stiffness is K T^2 / m. The damping at which an undamped device is given
  // the stiffest wall, and points of the edge beside it.
  struct Edge {
    int delay;
    double beta;
  };
  for (const Edge& e :
       {Edge{0, 0.82843}, Edge{1, 0.42469}, Edge{2, 0.29139}, Edge{3, 0.22238}, Edge{5, 0.15115},
        Edge{10, 0.08405}, Edge{0, 0.1}, Edge{0, 0.2}, Edge{0, 0.4}, Edge{1, 0.1}, Edge{1, 0.2},
        Edge{1, 0.4}, Edge{5, 0.05}, Edge{5, 0.1}}) {
    add(fmt::format("undamped/d{}/beta{:g}", e.delay, e.beta),
        {.mass = 1.0, .period = 1.0, .wall_damping = e.beta, .delay = e.delay});
  }
}

struct Cycle {
  double stiffness, amplitude, frequency;
  int delay;
  double millijoules;
};

// The energy meter of a device so heavy that the spring moves it by a millionth.
CaseFigures cycle(const Cycle& of) {
  constexpr double kMass = 1e7, kPeriod = 1e-3;
  const double w = 2.0 * pi * of.frequency;
  const PassiveGrip swing{.stiffness = kMass * w * w};
  BareDevice device({kMass, 0.0, 0.0}, swing, Vec2::Zero());
  device.kick({of.amplitude * w, 0.0});
  std::deque<double> late(static_cast<std::size_t>(of.delay), 0.0);
  const auto ticks = static_cast<int>(std::lround(1.0 / (of.frequency * kPeriod)));
  double before = 0.0;
  for (int i = 0; i < 2 * ticks; ++i) {
    if (i == ticks) before = device.given();  // all that is late is under way
    late.push_back(-of.stiffness * device.position().x());
    device.advance(kPeriod, {late.front(), 0.0});
    late.pop_front();
  }
  const double made = 1e3 * (device.given() - before);
  const double law =
      1e3 * energy_per_cycle(of.stiffness, of.amplitude, of.frequency, kPeriod, of.delay * kPeriod);
  return {judged("off", off(made, of.millijoules), kCycleWithin),
          judged("off_law", off(made, law), kCycleWithin), told("measured_mj", made),
          told("expected_mj", of.millijoules)};
}

void add_cycles(std::vector<StabilityCase>& out) {
  for (const Cycle& c : {Cycle{1000, 5e-3, 1, 0, 0.24674}, Cycle{1000, 5e-3, 5, 0, 1.23360},
                         Cycle{1000, 5e-3, 5, 10, 25.4394}, Cycle{800, 5e-3, 2, 7, 5.91296},
                         Cycle{200, 20e-3, 1, 100, 148.364}}) {
    out.push_back({fmt::format("cycle/K{:g}/{:g}Hz/d{}", c.stiffness, c.frequency, c.delay), true,
                   false, [c](std::uint64_t) { return cycle(c); }});
  }
}

struct Hidden {
  double mass, damping, friction, stiffness;
  int delay;
  double speed;  // simulated with sticking, in steps of a twentieth of a period [m/s]
};

CaseFigures hidden(const Hidden& of) {
  const SampledWall wall{.mass = of.mass, .damping = of.damping, .delay = of.delay};
  const double formula = speed_that_grows(wall, of.stiffness, of.friction).value_or(std::nan(""));
  const double measured = measured_speed_that_grows(wall, of.stiffness, of.friction, formula);
  // An oscillation that is a tenth slower must die away: the formula is on the safe side.
  return {judged("off", off(measured, of.speed), kSpeedWithin),
          judged("formula_over", formula / measured, 1.0), told("measured_m_s", measured),
          told("expected_m_s", of.speed), told("formula_m_s", formula)};
}

void add_hidden(std::vector<StabilityCase>& out) {
  for (const Hidden& h :
       {Hidden{0.1, 0.1, 0.2, 1000, 0, 0.680}, Hidden{0.1, 0.1, 0.2, 2000, 0, 0.301},
        Hidden{0.1, 0.1, 0.2, 500, 1, 0.403}, Hidden{0.1, 0.1, 0.2, 500, 5, 0.106},
        Hidden{0.5, 0.5, 0.5, 1000, 2, 0.325}, Hidden{0.045, 0, 0.26, 800, 0, 0.874},
        Hidden{0.045, 0, 0.26, 5000, 0, 0.142}}) {
    out.push_back({fmt::format("friction/m{:g}/K{:g}/d{}", h.mass, h.stiffness, h.delay), true,
                   false, [h](std::uint64_t) { return hidden(h); }});
  }
}

// A step is a product with a matrix of 6 entries: it errs by at most 8 units in the last place of
// what there is, and errors add up at most as if all went one way.
CaseFigures keeps_energy(double stiffness) {
  constexpr int kSteps = 1'000'000;
  constexpr double kStep = 1e-5;  // [s]
  BareDevice device({0.1, 0.0, 0.0}, {.stiffness = stiffness}, Vec2::Zero(), kStep);
  device.kick({0.5, 0.3});
  const double before = device.energy();
  for (int i = 0; i < kSteps; ++i) device.advance(kStep, Vec2::Zero());
  return {judged("drift", std::abs(device.energy() / before - 1.0),
                 8.0 * kSteps * std::numeric_limits<double>::epsilon())};
}

// A spring that is held for a thousandth of a millisecond: late by half of it, which is a damping
// of -K T / 2. Its oscillation grows at K T / (4 m), to a share of w T.
CaseFigures fine_spring() {
  const SampledWall wall{.mass = 0.1, .period = 1e-6};
  constexpr double kStiffness = 1000.0;
  const double expected = kStiffness * wall.period / (4.0 * wall.mass);
  const double measured = growth_rate(wall, kStiffness);
  return {judged("off", off(measured, expected), 0.01), told("measured_1_s", measured),
          told("expected_1_s", expected)};
}

// A device with everything, on a held spring of the plane.
CaseFigures finer(double damping, double friction, double grip) {
  constexpr int kTicks = 1000;
  constexpr double kPeriod = 1e-3, kStiffness = 800.0;
  const DeviceBody body{0.1, damping, friction};
  const PassiveGrip hand{grip > 0.0 ? 0.12 : 0.0, grip > 0.0 ? 2.0 : 0.0, grip, {0.1, 0.0}};
  BareDevice coarse(body, hand, Vec2::Zero());
  BareDevice fine(body, hand, Vec2::Zero(), 0.01 * BareDevice::kStep);
  double apart = 0.0;
  for (BareDevice* device : {&coarse, &fine}) device->kick({0.5, 0.3});
  for (int i = 0; i < kTicks; ++i) {
    for (BareDevice* device : {&coarse, &fine}) {
      device->advance(kPeriod, -kStiffness * device->position());
    }
    apart = std::max(apart, (coarse.position() - fine.position()).norm());
  }
  return {judged("apart_um", 1e6 * apart, 1e6 * BareDevice::kFinerMoves)};
}

void add_steps(std::vector<StabilityCase>& out) {
  const auto add = [&out](const std::string& name, std::function<CaseFigures()> run) {
    out.push_back({name, true, false, [run](std::uint64_t) { return run(); }});
  };
  add("energy/free", [] { return keeps_energy(0.0); });
  add("energy/spring", [] { return keeps_energy(500.0); });
  add("energy/fine-spring", fine_spring);
  add("finer/plain", [] { return finer(0.1, 0.0, 0.0); });
  add("finer/friction", [] { return finer(0.1, 0.2, 0.0); });
  add("finer/grip", [] { return finer(0.5, 0.26, 500.0); });
}

}  // namespace

std::vector<StabilityCase> truth_cases() {
  std::vector<StabilityCase> out;
  add_onsets(out);
  add_cycles(out);
  add_hidden(out);
  add_steps(out);
  return out;
}

}  // namespace handrail
