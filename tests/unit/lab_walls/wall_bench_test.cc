#include "server/lab/walls/wall_bench.h"

#include <gtest/gtest.h>

#include "server/lab/walls/joystick_people.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

// Walls and the device's mass alone, so that every force is known.
Scene plain_scene() {
  Scene scene = *SceneLibrary().load("gearshift");
  std::erase_if(scene.effects, [](const EffectSpec& e) {
    return e.kind != EffectKind::kWall && e.kind != EffectKind::kDeviceInertia;
  });
  return scene;
}

TEST(WallBench, EffortAndDeviceTogetherAreWhatMovesHandAndDevice) {
  const Scene scene = plain_scene();
  WallBench bench(scene, joystick_person(1, 0).hand);
  Vec2 impulse = Vec2::Zero(), device = Vec2::Zero();
  double hardest = 0.0;
  for (int i = 0; i < 1500; ++i) {
    // Into the wall beside neutral, as fast as the hand can.
    bench.follow(Vec2(0.02, 0.05), Vec2::Zero());
    const WallTick& tick = bench.step();
    impulse += kBenchTick * (tick.effort + device);
    device = tick.device;
    hardest = std::max(hardest, tick.device.norm());
    const Vec2 momentum = bench.moving_mass() * tick.velocity;
    ASSERT_LT((momentum - impulse).norm(), 0.01) << "at " << tick.t << " s";
  }
  EXPECT_GT(hardest, 3.0) << "no wall was met";
}

TEST(WallBench, TheWallsForceIsToldApartFromOtherEffects) {
  const Scene scene = *SceneLibrary().load("gearshift");
  WallBench bench(scene, joystick_person(1, 0).hand);
  std::size_t apart = 0, alone = 0;
  for (int i = 0; i < 1500; ++i) {
    bench.follow(Vec2(0.02, 0.05), Vec2::Zero());
    const WallTick& tick = bench.step();
    ASSERT_TRUE(tick.contact.touching || tick.wall == Vec2(0.0, 0.0));
    apart += tick.contact.touching && (tick.device - tick.wall).norm() > 1.0;
    alone += !tick.contact.touching && tick.device.norm() > 1.0;
  }
  EXPECT_GT(apart, 100u) << "the return spring's pull is not the wall's";
  EXPECT_GT(alone, 10u);
}

TEST(WallBench, ARecordingIsLaidOnTheMiddle) {
  const Scene scene = plain_scene();
  const RecordedMotion motion({{0.0, Vec3(1.0, 0.0, 0.0)}, {0.2, Vec3(1.02, 0.0, 0.0)}});
  WallBench bench(scene, joystick_person(1, 0).hand, motion, Vec2(0.0, 0.002));
  EXPECT_LT((bench.step().hand - Vec2(-0.010, 0.002)).norm(), 1e-3);
}

}  // namespace
}  // namespace handrail
