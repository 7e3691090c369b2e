// One update of the sub-pixel proxy at 0.1 mm of hand motion a tick, its worst tick, and the build.
#include <cmath>
#include <map>
#include <memory>

#include "server/constraint/painted/subpixel_wall.h"
#include "tests/bench/percentile.h"
#include "tests/support/wall_samples.h"

namespace handrail::bench {
namespace {

constexpr double kPixel = 1e-4, kStep = 1e-4;
constexpr double kRadius = 5e-3;

// A disc of wall, or a round room, in a map of `size` x `size`; one of each kind is kept.
const Walls& round(int size, bool solid) {
  static std::map<std::pair<int, bool>, std::unique_ptr<Walls>> kept;
  std::unique_ptr<Walls>& walls = kept[{size, solid}];
  if (walls == nullptr) {
    test::WallPainter painter(size, size, kPixel, solid);
    if (solid) {
      painter.wall_disc(Vec2::Zero(), kRadius);
    } else {
      painter.open_disc(Vec2::Zero(), kRadius);
    }
    walls = std::make_unique<Walls>(painter.finish({0.0, solid ? 1.2 * kRadius : 0.0}));
  }
  return *walls;
}

// A hand going round at `r`, `step` a tick.
struct Circling {
  std::unique_ptr<WallProxy> proxy;
  double r, turn, angle = 0.5 * 3.14159265358979;

  Circling(const Walls& walls, double radius, double step)
      : proxy(make_subpixel_proxy(walls)), r(radius), turn(step / radius) {
    proxy->start(walls.start);
  }
  WallContact operator()() {
    angle += turn;
    return proxy->advance({r * std::cos(angle), r * std::sin(angle)});
  }
};

void run_round(benchmark::State& s, const char* name, double target, int size, bool solid, double r,
               double step = kStep) {
  run(s, name, 1, target, Circling(round(size, solid), r, step));
}

void concave(benchmark::State& s) {
  run_round(s, "subpixel/concave", 150.0, 1000, false, 1.2 * kRadius);
}
void shallow(benchmark::State& s) {
  run_round(s, "subpixel/convex r/20 deep", 150.0, 1000, true, 0.95 * kRadius);
}
void deep(benchmark::State& s) {
  run_round(s, "subpixel/convex r/2 deep", 350.0, 1000, true, 0.5 * kRadius);
}
void deepest(benchmark::State& s) {
  run_round(s, "subpixel/convex 0.9 r deep", 350.0, 1000, true, 0.1 * kRadius);
}
void large(benchmark::State& s) {
  run_round(s, "subpixel/concave 8000 x 8000", 150.0, 8000, false, 1.2 * kRadius);
}
void fast(benchmark::State& s) {
  run_round(s, "subpixel/concave at 5 m/s", 0.0, 1000, false, 1.2 * kRadius, 5e-3);
}
void build(benchmark::State& s) {
  const Walls& walls = round(2000, false);
  run(s, "subpixel/build 2000 x 2000", 1, 2.5e8,
      [&] { return make_subpixel_proxy(walls)->memory(); });
}

BENCHMARK(concave)->Name("subpixel_concave");
BENCHMARK(shallow)->Name("subpixel_convex_shallow");
BENCHMARK(deep)->Name("subpixel_convex_deep");
BENCHMARK(deepest)->Name("subpixel_convex_deepest");
BENCHMARK(large)->Name("subpixel_concave_8000");
BENCHMARK(fast)->Name("subpixel_concave_fast");
BENCHMARK(build)->Name("subpixel_build_2000")->Iterations(3);

[[maybe_unused]] const bool walls_compared = [] {
  compare("subpixel/concave 8000 x 8000", "subpixel/concave", 1.2);
  return true;
}();

}  // namespace
}  // namespace handrail::bench
