// The verdict on prices, and that effects a scene does not list are not there to cost anything.
#include "server/lab/scenes/price_command.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>

#include "devices/joystick/joystick_data.h"
#include "server/master/wall_runs.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(PriceCheck, ASavingMayDifferByTheLargerOf15PercentAnd5Nanoseconds) {
  EXPECT_TRUE((CheckedPrice{"wall", 20.0, 24.9}).agrees());
  EXPECT_FALSE((CheckedPrice{"wall", 20.0, 25.1}).agrees());
  EXPECT_FALSE((CheckedPrice{"wall", 20.0, 14.9}).agrees());
  EXPECT_TRUE((CheckedPrice{"wall", 100.0, 114.9}).agrees());
  EXPECT_FALSE((CheckedPrice{"wall", 100.0, 84.9}).agrees());
  EXPECT_TRUE((CheckedPrice{"wall", 0.0, -4.9}).agrees());
}

TEST(PriceCheck, TheTableShowsBothPricesAndTheVerdict) {
  const CheckedPrice good{"wall", 20.0, 21.5}, bad{"detent", 6.0, 17.0};
  EXPECT_THAT(price_table({good}), AllOf(HasSubstr("20.0"), HasSubstr("21.5"), HasSubstr("agrees"),
                                         HasSubstr("every price"), Not(HasSubstr("DIFFERS"))));
  EXPECT_THAT(price_table({good, bad}), AllOf(HasSubstr("DIFFERS"), HasSubstr("1 of 2 prices")));
}

// How many effects of each kind stand in a stack, in the order of EffectKind's first seven.
std::array<int, 7> counts(const EffectStack& stack) {
  return {stack.find<WallSpring>() != nullptr,          stack.find<ViscousAisle>() != nullptr,
          stack.find<ProgressiveFriction>() != nullptr, stack.find<Detent>() != nullptr,
          stack.find<ReturnSpring>() != nullptr,        stack.find<CoulombFriction>() != nullptr,
          stack.find<OneWayAisle>() != nullptr};
}

const std::array<EffectKind, 7> kKinds = {
    EffectKind::kWall,   EffectKind::kViscous, EffectKind::kProgressive, EffectKind::kDetent,
    EffectKind::kReturn, EffectKind::kCoulomb, EffectKind::kOneWay};

// As the master makes a scene's effects ready: those listed, once each, and no other.
void expect_what_is_listed(const Scene& scene) {
  const auto run = make_wall_run(scene, joystick_capabilities());
  const std::array<int, 7> there = counts(run->state.effects);
  int listed_in_all = 0;
  for (std::size_t i = 0; i < kKinds.size(); ++i) {
    const auto listed = std::count_if(scene.effects.begin(), scene.effects.end(),
                                      [&](const EffectSpec& e) { return e.kind == kKinds[i]; });
    EXPECT_EQ(there[i], listed) << scene.name << ": " << name_of(kKinds[i]);
    listed_in_all += static_cast<int>(listed);
  }
  EXPECT_EQ(run->state.effects.size(), listed_in_all);
}

TEST(PriceCheck, AnEffectThatASceneDoesNotListIsNotConstructed) {
  for (const char* name : {"gearshift", "wrench", "painted-aisle"}) {
    const Scene scene = *SceneLibrary().load(name);
    expect_what_is_listed(scene);
    for (std::size_t i = 0; i < scene.effects.size(); ++i) {
      Scene less = scene;
      less.effects.erase(less.effects.begin() + static_cast<std::ptrdiff_t>(i));
      expect_what_is_listed(less);
      const DeviceEffects device = device_effects(less.effects);
      const EffectKind kind = scene.effects[i].kind;
      EXPECT_EQ(device.inertia, kind != EffectKind::kDeviceInertia);
      EXPECT_EQ(device.friction, kind != EffectKind::kDeviceFriction);
      EXPECT_EQ(device.quantisation, kind != EffectKind::kDeviceQuantisation);
      EXPECT_EQ(device.force_limits, kind != EffectKind::kDeviceForceLimits);
    }
  }
}

}  // namespace
}  // namespace handrail
