// What the rig's world costs: a step with one, two and four things touched, a key in its socket,
// and a rig with nothing to touch.
#include <cmath>
#include <memory>
#include <vector>

#include "devices/rig/rig.h"
#include "tests/bench/percentile.h"

namespace handrail::bench {
namespace {

constexpr double kWorldTarget = 2000.0;  // [ns]
constexpr int kWorldBatch = 20;

const Quat kDown(0.0, 1.0, 0.0, 0.0);

std::vector<RigEffectSpec> arm_and_tool() {
  return {ArmComplianceSpec(), ToolComplianceSpec(), ServoLagSpec(), SensorNoiseSpec()};
}

// Walls around the origin, of which the tip touches as many as there are.
Simulate corner(int walls) {
  const Vec3 normals[] = {Vec3::UnitZ(), Vec3::UnitX(), Vec3::UnitY(),
                          Vec3(-0.7, 0.0, 0.7).normalized()};
  Simulate out{arm_and_tool()};
  for (int i = 0; i < walls; ++i) out.effects.push_back(PlaneSpec{Vec3::Zero(), normals[i], {}});
  return out;
}

// The tip wanders 1 mm deep in what there is to touch, and turns.
struct Press {
  World world;
  double t = 0.0;
  explicit Press(const Simulate& list) : world(list, ArmGeometry(), JointVector::Zero()) {}
  const World* operator()() {
    t += 1e-3;
    const Vec3 p(-1.2e-3 + 0.4e-3 * std::sin(3.0 * t), -1.2e-3 + 0.4e-3 * std::sin(2.0 * t),
                 -1.2e-3 + 0.4e-3 * std::sin(5.0 * t));
    world.lead({p, rotation_exp(Vec3(0.1 * std::sin(t), 0.05, 0)) * kDown}, 1e-3);
    return &world;
  }
};

// In and out of a socket, turning, and pulled aside.
struct Fasten {
  World world;
  double t = 0.0;
  Fasten()
      : world({[] {
                auto list = arm_and_tool();
                list.push_back(HexSocketSpec());
                list.push_back(ScrewThreadSpec());
                return list;
              }()},
              ArmGeometry(), JointVector::Zero()) {}
  const World* operator()() {
    t += 1e-3;
    const Vec3 p(0.3e-3 * std::sin(3.0 * t), 0.3e-3 * std::sin(2.0 * t),
                 -3e-3 + 4e-3 * std::sin(1.3 * t));
    world.lead({p, rotation_exp(Vec3(0, 0, -0.8 * std::sin(0.4 * t))) * kDown}, 1e-3);
    return &world;
  }
};

// A millisecond of the rig with its arm on the way.
struct RigTick {
  std::shared_ptr<Rig> rig;
  Nanos now = 0;
  explicit RigTick(const RigOptions& options) : rig(std::make_shared<Rig>(options, 0)) {}
  const Rig* operator()() {
    now += kMillisecond;
    while (rig->next() <= now) {
      if (rig->step(now) != RigEvent::kControl) continue;
      JointVector q = ServoArmOptions::default_start();
      q[1] += 0.02 * std::sin(to_seconds(now));
      rig->controller().arm().command(q);
    }
    return rig.get();
  }
};

RigOptions rig_of(const std::vector<RigEffectSpec>& effects) {
  Scene scene;
  scene.simulate = Simulate{effects};
  RigOptions out;
  run_only_listed(scene, out);
  return out;
}
RigOptions with_floor(double z) {
  auto list = arm_and_tool();
  list.push_back(PlaneSpec{Vec3(0, 0, z), Vec3::UnitZ(), {}});
  return rig_of(list);
}

void one(benchmark::State& s) {
  run(s, "world/1 contact", kWorldBatch, kWorldTarget, Press(corner(1)));
}
void two(benchmark::State& s) {
  run(s, "world/2 contacts", kWorldBatch, kWorldTarget, Press(corner(2)));
}
void four(benchmark::State& s) {
  run(s, "world/4 contacts", kWorldBatch, kWorldTarget, Press(corner(4)));
}
void socket(benchmark::State& s) {
  run(s, "world/key and screw", kWorldBatch, kWorldTarget, Fasten());
}
void as_configured(benchmark::State& s) {
  run(s, "rig/ms as configured", kWorldBatch, 0.0, RigTick(RigOptions()));
}
void no_contact(benchmark::State& s) {
  run(s, "rig/ms nothing to touch", kWorldBatch, 0.0, RigTick(rig_of(arm_and_tool())));
  compare("rig/ms nothing to touch", "rig/ms as configured", 1.1);
}
void far(benchmark::State& s) {
  run(s, "rig/ms floor out of reach", kWorldBatch, 0.0, RigTick(with_floor(-1.0)));
}
void pressed(benchmark::State& s) {
  run(s, "rig/ms on the floor", kWorldBatch, 0.0, RigTick(with_floor(0.43)));
}

BENCHMARK(one)->Name("world_one_contact");
BENCHMARK(two)->Name("world_two_contacts");
BENCHMARK(four)->Name("world_four_contacts");
BENCHMARK(socket)->Name("world_key_and_screw");
BENCHMARK(as_configured)->Name("world_rig_as_configured");
BENCHMARK(no_contact)->Name("world_rig_nothing_to_touch");
BENCHMARK(far)->Name("world_rig_floor_out_of_reach");
BENCHMARK(pressed)->Name("world_rig_on_the_floor");

}  // namespace
}  // namespace handrail::bench
