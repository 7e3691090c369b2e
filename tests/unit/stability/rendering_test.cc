#include "server/stability/rendering.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "server/stability/sampled_wall.h"

namespace handrail {
namespace {

using testing::HasSubstr;

DeviceDynamics made_of(double mass, double damping, double friction) {
  DeviceDynamics out;
  out.mass = mass;
  out.damping = damping;
  out.friction = friction;
  out.resolution = 5e-5;
  return out;
}

const DeviceDynamics kLinear = made_of(0.1, 0.5, 0.0);
const DeviceDynamics kDry = made_of(0.045, 0.0, 0.26);

Rendering spring(double stiffness, double damping = 0.0, double delay = 0.0) {
  return {"spring", stiffness, damping, false, delay};
}

TEST(Rendering, ALinearDeviceHoldsUpToTheOnsetOfItsLoop) {
  for (const int periods : {0, 1, 2, 10}) {
    const SampledWall wall{.mass = 0.1, .damping = 0.5, .delay = periods};
    const StabilityMargin margin = margin_of(kLinear, {}, spring(100.0, 0.0, 1e-3 * periods));
    EXPECT_NEAR(margin.share * 100.0, stiffness_onset(wall), 1e-5 * stiffness_onset(wall));
    EXPECT_EQ(margin.by, StabilityLimit::kLoop);
  }
}

TEST(Rendering, StiffnessAndDampingGrowTogether) {
  const StabilityMargin margin = margin_of(kLinear, {}, spring(1000.0, 2.0));
  SampledWall wall{.mass = 0.1, .damping = 0.5};
  wall.wall_damping = 0.999 * margin.share * 2.0;
  EXPECT_TRUE(is_stable(wall, 0.999 * margin.share * 1000.0));
  wall.wall_damping = 1.001 * margin.share * 2.0;
  EXPECT_FALSE(is_stable(wall, 1.001 * margin.share * 1000.0));
}

TEST(Rendering, ADelayCountsAsNoLessThanItIs) {
  EXPECT_EQ(margin_of(kLinear, {}, spring(100.0, 0.0, 1.2e-3)).share,
            margin_of(kLinear, {}, spring(100.0, 0.0, 2e-3)).share);
}

// Friction holds what makes no more than it takes: K goes with 1 / (T / 2 + d)^2.
TEST(Rendering, APartOfAPeriodOfTheDevicesDelayCountsAsWhatItIs) {
  const auto held = [](double delay) {
    DeviceDynamics device = kDry;
    device.delay = delay;
    return margin_of(device, {}, spring(1000.0)).share;
  };
  EXPECT_NEAR(held(0.35e-3) / held(0.0), 0.25 / (0.85 * 0.85), 1e-9);
  EXPECT_NEAR(held(2.5e-3) / held(0.0), 0.25 / 9.0, 1e-9);
  DeviceDynamics linear = kLinear;
  linear.delay = 1.4e-3;
  SampledWall wall{.mass = 0.1, .damping = 0.5, .delay = 1};
  wall.late = 0.4;
  EXPECT_NEAR(margin_of(linear, {}, spring(100.0)).share * 100.0, stiffness_onset(wall),
              1e-5 * stiffness_onset(wall));
  // A rendering's own is beside it.
  wall.delay = 3;
  EXPECT_NEAR(margin_of(linear, {}, spring(100.0, 0.0, 1.2e-3)).share * 100.0,
              stiffness_onset(wall), 1e-5 * stiffness_onset(wall));
}

TEST(Rendering, ALowPassOfTheVelocityIsPartOfTheLoop) {
  RenderingLoop slow;
  slow.velocity_lag = 5e-3;
  const double with = margin_of(kLinear, slow, spring(1000.0, 5.0)).share;
  const double without = margin_of(kLinear, {}, spring(1000.0, 5.0)).share;
  EXPECT_LT(with, 0.8 * without);
  Rendering own = spring(1000.0, 5.0);
  own.own_velocity = true;
  EXPECT_EQ(margin_of(kLinear, slow, own).share, without);
}

// A mass with Coulomb friction in a spring on both sides that is held for a tick, at most `peak`,
// in steps 100 times finer; whether an oscillation that begins at `v` has grown after a second.
bool grows(const DeviceDynamics& device, double stiffness, double peak, double v) {
  constexpr double kFine = 1e-5;  // a hundredth of a tick [s]
  const double begun = v;
  double x = 0.0, most = 0.0;
  for (int tick = 0; tick < 1000; ++tick) {
    const double held = std::clamp(-stiffness * x, -peak, peak);
    for (int i = 0; i < 100; ++i) {
      const double free = v + held / device.mass * kFine;
      const double stop = device.friction / device.mass * kFine;
      v = std::abs(free) <= stop ? 0.0 : free - std::copysign(stop, free);
      x += v * kFine;
    }
    if (tick >= 900) most = std::max(most, std::abs(v));
  }
  return most > begun;
}

TEST(Rendering, WithinThePeakForceFrictionDecides) {
  const StabilityMargin margin = margin_of(kDry, {}, spring(1000.0));
  EXPECT_EQ(margin.by, StabilityLimit::kFriction);
  const double limit = margin.share * 1000.0;
  // Within the peak alone, by the describing function, it would be more: F (K T / 2) = (4 / pi) f_c
  // sqrt(K m).
  const double root = 4.0 / std::numbers::pi * 0.26 * std::sqrt(0.045) / (3.3 * 0.5e-3);
  EXPECT_LT(limit, 0.9 * root * root);
  EXPECT_GT(limit, 0.8 * root * root);
  // Whatever it begins with, below the limit nothing grows; well above something does.
  bool grown = false;
  for (double v = 0.1; v < 8.0; v *= 1.1) {
    EXPECT_FALSE(grows(kDry, limit, 3.3, v)) << v;
    grown = grown || grows(kDry, 1.2 * limit, 3.3, v);
  }
  EXPECT_TRUE(grown);
}

TEST(Rendering, ADamperThatIsInTimeDoesNotSpoilWhatFrictionHolds) {
  RenderingLoop slow;
  slow.velocity_lag = 5.3e-3;
  const double bare = margin_of(kDry, slow, spring(1000.0)).share;
  EXPECT_EQ(margin_of(kDry, slow, spring(1000.0, 0.4)).share, bare);
  EXPECT_NEAR(most_stiffness(kDry, slow, 0.4), 1000.0 * bare, 1e-6);
  // An oscillation so quick that the damper pushes the way it goes.
  const StabilityMargin quick = margin_of(made_of(1e-3, 0.0, 1.0), slow, spring(1000.0, 0.4));
  EXPECT_EQ(quick.by, StabilityLimit::kLoop);
}

TEST(Rendering, FrictionHasToHoldACount) {
  DeviceDynamics coarse = kDry;
  coarse.resolution = 1e-3;
  const StabilityMargin margin = margin_of(coarse, {}, spring(1000.0));
  EXPECT_EQ(margin.by, StabilityLimit::kCounts);
  EXPECT_NEAR(margin.share * 1000.0, 2.0 * 0.26 / 1e-3, 1e-9);
  coarse.resolution = 0.0;
  EXPECT_EQ(margin_of(coarse, {}, spring(1000.0)).share, 0.0) << "not declared";
}

TEST(Rendering, WithoutAMassOnlyWhatIsPassiveCounts) {
  const StabilityMargin margin = margin_of(made_of(0.0, 1.0, 0.0), {}, spring(1000.0));
  EXPECT_EQ(margin.by, StabilityLimit::kUnknown);
  EXPECT_NEAR(margin.share, 2.0, 1e-9);  // b >= K T / 2
  EXPECT_EQ(margin_of(made_of(0.0, 0.0, 1.0), {}, spring(1000.0)).share, 0.0);
  EXPECT_EQ(most_stiffness(made_of(0.0, 0.0, 1.0), {}, 0.0), 0.0);
}

// A force stick of unknown mass: what `--check` says of a tool is what is rendered.
TEST(Rendering, WithoutAMassADelayCountsToo) {
  DeviceDynamics late = made_of(0.0, 10.0, 0.0);
  for (const double delay : {0.0, 0.4e-3, 18e-3}) {
    late.delay = delay;
    for (const double damping : {0.0, 0.5, 5.0}) {
      const double most = most_stiffness(late, {}, damping);
      EXPECT_GT(most, 0.0) << delay << " " << damping;
      EXPECT_NEAR(margin_of(late, {}, spring(most, damping)).share, 1.0, 1e-6)
          << delay << " " << damping;
    }
    const double whole = std::ceil(delay * 1e3 - 1e-9) * 1e-3;
    EXPECT_NEAR(most_stiffness(late, {}, 0.0), 10.0 / (0.5e-3 + whole), 1e-6) << delay;
  }
  EXPECT_EQ(most_stiffness(late, {}, 11.0), 0.0) << "the damper alone is more than is passive";
}

TEST(Rendering, ANumberThatIsNoneHoldsNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  DeviceDynamics device = kLinear;
  for (double* value : {&device.mass, &device.damping, &device.friction, &device.resolution}) {
    const double was = *value;
    for (const double bad : {nan, -1.0, std::numeric_limits<double>::infinity()}) {
      *value = bad;
      EXPECT_EQ(margin_of(device, {}, spring(100.0)).by, StabilityLimit::kInvalid) << bad;
      EXPECT_EQ(margin_of(device, {}, spring(100.0)).share, 0.0) << bad;
      EXPECT_EQ(most_stiffness(device, {}, 0.0), 0.0) << bad;
    }
    *value = was;
  }
  EXPECT_EQ(margin_of(kLinear, {}, spring(100.0, 0.0, -1e-3)).share, 0.0);
  EXPECT_EQ(margin_of(kLinear, {}, spring(100.0, 0.0, nan)).share, 0.0);
}

TEST(Rendering, MostStiffnessIsWhatTheMarginLeaves) {
  for (const double damping : {0.0, 1.0}) {
    const double most = most_stiffness(kLinear, {}, damping);
    SampledWall wall{.mass = 0.1, .damping = 0.5};
    wall.wall_damping = damping;
    EXPECT_TRUE(is_stable(wall, 0.999 * most)) << damping;
    EXPECT_FALSE(is_stable(wall, 1.001 * most)) << damping;
  }
}

TEST(Rendering, AScenesWallsAddUpWithTheEffectsThatActBesideThem) {
  Scene scene;
  auto walls = std::make_shared<Walls>();
  const auto wall = [&walls](const char* name, double stiffness) {
    WallRegion& region = walls->regions.emplace_back();
    region.name = name;
    region.kind = RegionKind::kWall;
    region.stiffness = stiffness;
  };
  walls->regions.emplace_back();
  wall("brick", 4000.0);
  wall("foam", 500.0);
  scene.walls = walls;
  scene.effects.resize(2);  // the walls', and
  scene.effects[1].kind = EffectKind::kReturn;
  scene.effects[1].stiffness = 150.0;
  const auto all = renderings_of(scene, {});
  ASSERT_EQ(all.size(), 4u);
  EXPECT_THAT(all[0].name, HasSubstr("'brick'"));
  EXPECT_THAT(all[2].name, HasSubstr("'return_spring'"));
  EXPECT_EQ(all[3].name, "all together");
  EXPECT_EQ(all[3].stiffness, 4150.0);
  scene.effects.erase(scene.effects.begin());
  EXPECT_EQ(renderings_of(scene, {}).size(), 1u) << "walls that no effect renders";
}

TEST(Rendering, AnArmsSpringIsAsLateAsItsSmoother) {
  Scene scene;
  ToolCall& line = scene.tools.emplace_back();
  line.kind = ToolKind::kLine;
  line.stiffness = 1500.0;
  const auto all = renderings_of(scene, {});
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].stiffness, 800.0);
  EXPECT_EQ(all[1].stiffness, 1500.0);
  EXPECT_EQ(all[2].stiffness, 200.0);
  EXPECT_NEAR(all[2].delay, 99.5e-3, 1e-12);
}

TEST(Rendering, OrientationToolsTurn) {
  Scene scene;
  ToolCall& own = scene.tools.emplace_back();
  own.kind = ToolKind::kNRotation;
  own.stiffness = 2.0;
  scene.tools.emplace_back().kind = ToolKind::kFRotation;  // as stiff as the scene says
  const auto all = turnings_of(scene);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].name, "orientation tools");
  EXPECT_EQ(all[0].stiffness, 0.5);
  EXPECT_EQ(all[1].name, "tool 'n-rotation'");
  EXPECT_EQ(all[1].stiffness, 2.0);
  EXPECT_TRUE(all[0].turns && all[1].turns);
  for (const Rendering& r : renderings_of(scene, {})) EXPECT_FALSE(r.turns) << r.name;
  scene.walls = std::make_shared<Walls>();
  EXPECT_TRUE(turnings_of(scene).empty());
}

TEST(Rendering, WallsAndDetentsCountAsTheirHardestStageMakesThem) {
  Scene scene;
  auto walls = std::make_shared<Walls>();
  WallRegion wall;
  wall.name = "rim";
  wall.kind = RegionKind::kWall;
  wall.stiffness = 2000.0;
  walls->regions = {wall};
  walls->stages.resize(3);
  walls->stages[1].name = "hard";
  walls->stages[1].regions = walls->regions;
  walls->stages[1].regions[0].stiffness = 9000.0;
  walls->stages[2].regions = walls->regions;
  walls->stages[2].detent_peaks = {5.0};
  scene.walls = walls;
  EffectSpec spring, detent;
  detent.kind = EffectKind::kDetent;
  detent.places = {Vec2::Zero()};
  detent.radius = 4e-3;
  detent.peak = 1.0;
  scene.effects = {spring, detent};
  std::vector<std::string> names;
  std::vector<double> stiffness;
  for (const Rendering& r : renderings_of(scene, {})) {
    names.push_back(r.name);
    stiffness.push_back(r.stiffness);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"wall 'rim'", "wall 'rim' in stage 'hard'",
                                             "effect 'detent'", "all together"}));
  EXPECT_EQ(stiffness, (std::vector<double>{2000.0, 9000.0, 2500.0, 11500.0}));
}

}  // namespace
}  // namespace handrail
