#include "server/lab/scenes/effect_price.h"

#include <gtest/gtest.h>

#include <cmath>

#include "devices/joystick/joystick_data.h"

namespace handrail {
namespace {

TEST(EffectPrice, NamesEveryListedEffectOnceInTheScenesOrder) {
  auto walls = std::make_shared<Walls>();
  WallRegion wall;
  wall.kind = RegionKind::kWall;
  walls->method = WallMethod::kExact;
  walls->regions = {WallRegion(), wall};
  walls->outside = 1;
  WallShape shape;
  shape.half = Vec2(0.02, 0.02);
  walls->shapes = {shape};
  walls->stages.resize(1);
  Scene scene;
  scene.walls = walls;
  for (const EffectKind kind :
       {EffectKind::kCoulomb, EffectKind::kDeviceFriction, EffectKind::kWall}) {
    EffectSpec effect;
    effect.kind = kind;
    scene.effects.push_back(effect);
  }
  std::vector<HandReading> motion(500);
  for (std::size_t i = 0; i < motion.size(); ++i) {
    motion[i].X_MH.p.x() = 0.025 * std::sin(0.0126 * static_cast<double>(i));
    motion[i].valid = true;
  }
  const StepPrice price = price_effects(scene, joystick_capabilities(), motion, 20, 2);
  ASSERT_EQ(price.effects.size(), 3u);
  EXPECT_EQ(price.effects[0].kind, EffectKind::kCoulomb);
  EXPECT_EQ(price.effects[1].kind, EffectKind::kDeviceFriction);
  EXPECT_EQ(price.effects[2].kind, EffectKind::kWall);
  EXPECT_GT(price.step_ns, 0.0);
  EXPECT_GT(price.device_ns, 0.0);
  for (const EffectPrice& p : price.effects) EXPECT_TRUE(std::isfinite(p.ns));
}

}  // namespace
}  // namespace handrail
