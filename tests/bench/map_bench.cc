// What loading a painted map costs: reading the file, coverage and all checks.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "server/scene/scene_io.h"
#include "tests/support/png_sample.h"
#include "tests/support/temp_folder.h"

namespace handrail::bench {
namespace {

// Ring aisles about the middle of a square map, joined by a straight one, at 0.1 mm a pixel.
std::string write_scene(const TempFolder& folder, int size) {
  test::PngSample png;
  png.width = png.height = size;
  png.type = 2;
  png.pixel = [size](int x, int y) {
    const double u = x + 0.5 - 0.5 * size, v = y + 0.5 - 0.5 * size;
    const double ring = std::abs(std::remainder(std::hypot(u, v) + 0.037 * size, 0.1 * size));
    const double outside = std::min(ring - 0.02 * size, std::abs(v) - 0.01 * size);
    const double open = std::clamp(0.5 - outside, 0.0, 1.0);
    const auto grey = static_cast<std::uint8_t>(std::lround(255.0 * open));
    return test::Pixel{grey, grey, grey, 255};
  };
  folder.write("map.png", test::png_of(png));
  const std::string mm = std::to_string(size / 10);
  return folder.write("map.scene", "name: 'map'\nwalls { image { file: 'map.png' size_mm: [" + mm +
                                       ", " + mm +
                                       "] edges: SRGB }\n"
                                       "region { name: 'wall' colour: '#000000' kind: WALL }\n"
                                       "region { name: 'free' colour: '#ffffff' kind: FREE } }\n");
}

void load_painted_map(benchmark::State& state) {
  const TempFolder folder;
  const std::string file = write_scene(folder, static_cast<int>(state.range(0)));
  for (auto _ : state) {
    const Result<Scene> scene = load_scene_file(file);
    if (!scene) state.SkipWithError(scene.message().c_str());
    benchmark::DoNotOptimize(scene.is_ok());
  }
}
BENCHMARK(load_painted_map)->Arg(1000)->Arg(2000)->Arg(8000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace handrail::bench
