// What a recording costs the real-time thread: a tick that is kept, and an image.
#include <benchmark/benchmark.h>

#include <memory>

#include "devices/omni/sim_omni.h"
#include "server/master/haptic_settings.h"
#include "server/record/record_tap.h"
#include "server/scene/scene_library.h"
#include "tests/bench/percentile.h"

namespace handrail {
namespace {

HapticRun a_run() {
  const Scene scene = *SceneLibrary().load("linear-movement");
  const HapticCapabilities device = SimOmni(HandOptions(), false).capabilities();
  return HapticRun({haptic_settings(scene, device), nullptr, 1});
}

// Beside the whole tick, in one run: what leaving it for the recorder adds. Target: 1 us.
void BM_recorded_tick(benchmark::State& state) {
  HapticRun run = a_run();
  run.begin(1);
  const auto tap = std::make_unique<MasterTap>();
  const auto out = std::make_unique<KeptTick>();
  KeptTick kept;
  kept.given.dt = 1e-3;
  kept.given.in.hand.valid = true;
  bench::Samples ticks, keeps;
  for ([[maybe_unused]] auto _ : state) {
    kept.given.in.hand.X_MH.p.x() += 1e-9;
    ticks.time([&] { return run.tick(kept.given).out.f_H_M.force.x(); });
    keeps.time([&] {
      kept.came = run.result();
      tap->keep(kept);
      return kept.number;
    });
    while (tap->take(*out)) continue;
  }
  bench::put("master tick, nobody records", ticks);
  bench::put("leaving a tick for the recorder", keeps, 1000.0);
}

void BM_recorded_image(benchmark::State& state) {
  HapticRun run = a_run();
  const auto tap = std::make_unique<MasterTap>();
  const auto out = std::make_unique<MasterTap::Image>();
  bench::Samples images;
  for ([[maybe_unused]] auto _ : state) {
    images.time([&] {
      tap->image().size = run.save(tap->image().bytes);
      tap->keep_image(0);
      return tap->image().size;
    });
    while (tap->take(*out)) continue;
  }
  bench::put("an image for the recorder, each 5 s", images);
}

BENCHMARK(BM_recorded_tick);
BENCHMARK(BM_recorded_image);

}  // namespace
}  // namespace handrail
