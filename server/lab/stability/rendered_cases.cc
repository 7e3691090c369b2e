// The master's own wall is the sampled spring of theory: it gets unstable where that does.
#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <numbers>

#include "server/lab/stability/bench_scene.h"
#include "server/lab/stability/sampled_loop.h"
#include "server/lab/stability/stability_case.h"
#include "server/master/wall_runs.h"

namespace handrail {
namespace {

constexpr double kBeside = 0.03;  // of the onset, before and behind it

// Of a small swing about where a device rests that leans into the wall, far from its surface.
double rendered_growth(const BenchDevice& device, double rate, double stiffness) {
  constexpr double kDepth = 5e-3, kKick = 1e-3;  // [m], [m/s]
  WallCell cell;
  cell.device = &device;
  cell.stiffness = stiffness;
  const auto walls = make_wall_run(bench_scene(cell), device.capabilities);
  const PassiveGrip lean{.push = {kDepth * stiffness, 0.0}};
  const double period = 1.0 / rate;
  BareDevice body(device.body(), lean, {kDepth, 0.0}, period);
  WallInput in;
  in.hand.valid = true;
  in.hand.X_MH.p.x() = -kDepth;  // the proxy begins in free space
  WallOutput out;
  wall_step(walls->settings, in, period, walls->state, out);
  for (int i = 0; i < 100; ++i) {  // the arbiter lets the force come within its step
    in.hand.X_MH.p.x() = kDepth;
    wall_step(walls->settings, in, period, walls->state, out);
  }
  body.kick({kKick, 0.0});
  const auto next = [&] {
    in.hand.X_MH.p.head<2>() = body.position();
    in.hand.v_MH.head<2>() = body.velocity();
    wall_step(walls->settings, in, period, walls->state, out);
    body.advance(period, out.f_H_M.force.head<2>());
    return body.position().x() - kDepth;
  };
  const double swing = 2.0 * std::numbers::pi * std::sqrt(device.body().mass / stiffness) / period;
  return growth_of(next, static_cast<int>(swing), 0, period);
}

CaseFigures rendered_onset(const BenchDevice& of, double rate) {
  BenchDevice device = of;
  // Nothing of it cuts the force off.
  device.capabilities.max_force = device.capabilities.continuous_force = 1e3;
  const double onset = stiffness_onset(
      {.mass = device.body().mass, .damping = device.body().damping, .period = 1.0 / rate});
  return {judged("rate_below_1_s", rendered_growth(device, rate, (1.0 - kBeside) * onset), 0.0),
          judged("decay_above_1_s", -rendered_growth(device, rate, (1.0 + kBeside) * onset), 0.0),
          told("onset_n_m", onset)};
}

}  // namespace

std::vector<StabilityCase> rendered_cases() {
  std::vector<StabilityCase> out;
  for (const BenchDevice& device : bench_devices()) {
    if (device.body().friction > 0.0) continue;  // it hides the onset
    for (const double rate : {250.0, 500.0, 1000.0, 2000.0, 4000.0, 10000.0}) {
      out.push_back({fmt::format("rendered/{}/{:g}Hz", device.name, rate), true, false,
                     [&device, rate](std::uint64_t) { return rendered_onset(device, rate); }});
    }
  }
  return out;
}

}  // namespace handrail
