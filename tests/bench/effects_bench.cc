// Effects of a two-axis scene: the step among walls in closed form, with and without each effect,
// and the simulated joystick.
#include <cmath>
#include <vector>

#include "devices/joystick/sim_joystick.h"
#include "tests/bench/percentile.h"
#include "tests/unit/haptic/wall_rig.h"

namespace handrail::bench {
namespace {

constexpr int kEffectsBatch = 20;

// A hand in and out of wall and aisle at up to 0.2 m/s.
struct WallTick {
  test::WallRig rig;
  int n = 0;
  explicit WallTick(const std::vector<EffectSpec>& effects) : rig(effects) {}
  const WallOutput* operator()() {
    const double a = 1e-3 * ++n;
    rig.in.hand.X_MH.p = Vec3(0.01 * std::sin(7.0 * a) - 0.005, 0.02 * std::cos(5.0 * a), 0.0);
    wall_step(rig.settings, rig.in, 1e-3, rig.state, rig.out);
    benchmark::DoNotOptimize(rig.out);
    return &rig.out;
  }
};

struct JoystickTick {
  SimJoystick joystick;
  Nanos now = 0;
  explicit JoystickTick(const DeviceEffects& effects) : joystick(joystick_grip(), effects) {
    (void)joystick.open();
  }
  HapticSample operator()() {
    joystick.write({Vec3(0.5, -0.2, 0.0), Vec3::Zero()});
    return joystick.read(now += kMillisecond);
  }
};

DeviceEffects no_device_effects() { return device_effects({}); }

void no_effect(benchmark::State& s) {
  run(s, "wall_step/no effect", kEffectsBatch, 0.0, WallTick(std::vector<EffectSpec>{}));
}
void walls_only(benchmark::State& s) {
  run(s, "wall_step/wall", kEffectsBatch, 0.0, WallTick({test::effect(EffectKind::kWall)}));
}
void all_effects(benchmark::State& s) {
  run(s, "wall_step/all seven effects", kEffectsBatch, 0.0, WallTick(test::every_effect()));
}
void joystick_all(benchmark::State& s) {
  run(s, "joystick/tick", 1, 0.0, JoystickTick(DeviceEffects()));
}
void joystick_none(benchmark::State& s) {
  run(s, "joystick/tick without its effects", 1, 0.0, JoystickTick(no_device_effects()));
}

BENCHMARK(no_effect)->Name("wall_step_no_effect");
BENCHMARK(walls_only)->Name("wall_step_wall");
BENCHMARK(all_effects)->Name("wall_step_all_effects");
BENCHMARK(joystick_all)->Name("joystick_tick");
BENCHMARK(joystick_none)->Name("joystick_tick_bare");

}  // namespace
}  // namespace handrail::bench
