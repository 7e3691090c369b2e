// One update of the wall proxies: drawn lanes, and the published method on a painted wall.
#include <cmath>
#include <memory>

#include "server/haptic/wall_proxies.h"
#include "tests/bench/percentile.h"
#include "tests/support/wall_samples.h"
#include "tests/unit/constraint_drawn/shape_samples.h"

namespace handrail::bench {
namespace {

constexpr int kWallBatch = 20;

// A proxy and a hand that moves 0.1 mm a tick along a wavy way around the middle.
struct Update {
  Walls walls;
  std::unique_ptr<WallProxy> proxy;
  double reach;  // of the way [m]
  double phase = 0.0;

  Update(Walls of, double size) : walls(std::move(of)), reach(size) {
    proxy = make_wall_proxy(walls);
    proxy->start(walls.start);
  }
  Update(Update&& other) : Update(other.walls, other.reach) {}
  WallContact operator()() {
    phase += 1e-4 / reach;
    return proxy->advance({reach * std::sin(phase), reach * std::cos(0.9 * phase)});
  }
};

Walls published(double radius) {
  Walls walls = test::WallPainter(1000, 1000, 1e-4).wall_disc({0, 0}, 0.02).finish({0.03, 0.03});
  walls.method = WallMethod::kPublished;
  walls.search_radius = radius;
  return walls;
}

void exact_lanes(benchmark::State& s) {
  run(s, "wall/exact, gear lanes", kWallBatch, 0.0, Update(test::gear_lanes(), 0.045));
}
void exact_rounded_lanes(benchmark::State& s) {
  run(s, "wall/exact, rounded gear lanes", kWallBatch, 0.0, Update(test::gear_lanes(2e-3), 0.045));
}
void exact_ring(benchmark::State& s) {
  run(s, "wall/exact, ring", kWallBatch, 0.0,
      Update(test::drawn({test::ring({0, 0}, 0.03, 0.01)}), 0.03));
}
void exact_stairs(benchmark::State& s) {
  // From one end of 200 steps toward the other: a tick that meets its bound.
  const Walls walls = test::stairs(200);
  const auto proxy = make_wall_proxy(walls);
  run(s, "wall/exact, tick at its bound", 1, 0.0, [&] {
    proxy->start({0, 0.001});
    return proxy->advance({0.1995, 0.008});
  });
}
void published_1_5(benchmark::State& s) {
  run(s, "wall/published, radius 1.5", kWallBatch, 0.0, Update(published(1.5), 0.019));
}
void published_4(benchmark::State& s) {
  run(s, "wall/published, radius 4", kWallBatch, 0.0, Update(published(4.0), 0.019));
}

BENCHMARK(exact_lanes)->Name("wall_exact_lanes");
BENCHMARK(exact_rounded_lanes)->Name("wall_exact_rounded_lanes");
BENCHMARK(exact_ring)->Name("wall_exact_ring");
BENCHMARK(exact_stairs)->Name("wall_exact_worst");
BENCHMARK(published_1_5)->Name("wall_published_1_5");
BENCHMARK(published_4)->Name("wall_published_4");

}  // namespace
}  // namespace handrail::bench
