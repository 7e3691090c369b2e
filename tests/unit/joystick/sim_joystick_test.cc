#include "devices/joystick/sim_joystick.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "server/base/random.h"

namespace handrail {
namespace {

constexpr double kCount = 0.0942478e-3;  // 2 pi 150 mm / 10000

HandOptions still_hand(double grip = 0.5) {
  HandOptions options = joystick_grip(grip);
  options.tremor_rms = options.drift_rms = 0.0;
  options.reaction = 0.0;
  return options;
}

DeviceEffects all_but(bool DeviceEffects::*left_out) {
  DeviceEffects effects;
  effects.*left_out = false;
  return effects;
}

// Read once a millisecond.
class Bench {
 public:
  explicit Bench(const HandOptions& hand, const DeviceEffects& effects = {},
                 std::optional<RecordedMotion> recording = std::nullopt)
      : joystick(hand, effects, std::move(recording)) {
    EXPECT_TRUE(joystick.open().is_ok());
    sample = joystick.read(now_);
  }
  const HapticSample& tick(const Vec3& force = Vec3::Zero()) {
    joystick.write({force, Vec3::Zero()});
    return sample = joystick.read(now_ += kMillisecond);
  }
  void run(int ticks, const Vec3& force = Vec3::Zero()) {
    for (int i = 0; i < ticks; ++i) tick(force);
  }
  void steer(const Vec3& displacement, double duration = 1.0) {
    HandIntent intent;
    intent.displacement_M = displacement;
    intent.duration = duration;
    joystick.hand()->steer(intent);
  }

  SimJoystick joystick;
  HapticSample sample;

 private:
  Nanos now_ = 5 * kSecond;
};

TEST(SimJoystick, HomeIsWhereTheSceneStarts) {
  Bench bench(still_hand());
  const Vec3 start(-0.025, -0.01, 0.0);
  bench.joystick.simulate(DeviceEffects(), start);
  bench.run(4000);
  EXPECT_LT((bench.sample.X_MH.p - start).norm(), 0.5e-3);
  bench.steer(Vec3(0.03, 0.02, 0.0));
  bench.run(2500);
  ASSERT_GT((bench.sample.X_MH.p - start).norm(), 0.03);
  HandIntent home;
  home.home = true;
  bench.joystick.hand()->steer(home);
  bench.run(4000);
  EXPECT_LT((bench.sample.X_MH.p - start).norm(), 0.5e-3);
}

TEST(SimJoystick, CapabilitiesAreThoseOfTheDataSheet) {
  const HapticCapabilities c = joystick_capabilities();
  EXPECT_NEAR(c.max_force, 25.3, 0.05);
  EXPECT_NEAR(c.continuous_force, 8.5, 0.05);
  EXPECT_NEAR(c.dynamics.resolution, 0.0942e-3, 0.0001e-3);
  EXPECT_EQ(c.workspace_half.x(), 0.1);
  EXPECT_EQ(c.workspace_half.y(), 0.1);
  EXPECT_TRUE(c.simulated);
  EXPECT_FALSE(c.senses_rotation);
  EXPECT_FALSE(c.actuates_torque);
  // 5 N/mm at 1 kHz needs b >= K T / 2 and f_c >= K counts / 2.
  EXPECT_GE(kJoystickViscosity, 2.5);
  EXPECT_GE(kJoystickFriction, 0.24);
}

TEST(SimJoystick, ReadsPositionsInCountsAndStaysInThePlane) {
  Bench bench(joystick_grip(0.5, 3));
  bench.steer({0.05, -0.03, 0.04});
  bool moved = false;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 counts = bench.tick({1.0, 0.0, 3.0}).X_MH.p / kCount;
    for (int axis = 0; axis < 2; ++axis) EXPECT_NEAR(counts[axis], std::round(counts[axis]), 1e-3);
    EXPECT_EQ(counts.z(), 0.0);
    EXPECT_EQ(bench.sample.v_MH.z(), 0.0);
    moved = moved || counts.norm() > 100.0;
  }
  EXPECT_TRUE(moved);
}

TEST(SimJoystick, WithoutQuantisationItReadsThePlaceItself) {
  Bench bench(joystick_grip(), all_but(&DeviceEffects::quantisation));
  bench.steer({0.05, -0.03, 0.0});
  for (int i = 0; i < 500; ++i) {
    bench.tick();
    EXPECT_EQ(Vec2(bench.sample.X_MH.p.head<2>()), bench.joystick.position());
  }
}

TEST(SimJoystick, SaturatesAtItsPeakForce) {
  Bench peak(still_hand()), beyond(still_hand());
  Bench unlimited(still_hand(), all_but(&DeviceEffects::force_limits));
  for (Bench* bench : {&peak, &beyond, &unlimited}) {
    bench->run(3000, {bench == &peak ? kJoystickPeakForce : 30.0, 0.0, 0.0});
  }
  EXPECT_EQ(peak.sample.X_MH.p, beyond.sample.X_MH.p);
  EXPECT_NEAR(peak.sample.X_MH.p.x(), 25.3 / 350.0, 1.5e-3);
  EXPECT_NEAR(unlimited.sample.X_MH.p.x(), 30.0 / 350.0, 1.5e-3);
}

TEST(SimJoystick, FrictionSwallowsASmallForceWhereItIsSimulated) {
  Bench with(still_hand()), without(still_hand(), all_but(&DeviceEffects::friction));
  with.run(2000, {0.25, 0.0, 0.0});
  without.run(2000, {0.25, 0.0, 0.0});
  EXPECT_EQ(with.sample.X_MH.p, Vec3::Zero());
  EXPECT_NEAR(without.sample.X_MH.p.x(), 0.25 / 350.0, kCount);
}

// A force step on hand and device: x'' = f / m at first.
TEST(SimJoystick, InertiaSlowsItDownWhereItIsSimulated) {
  const auto way = [](const DeviceEffects& effects) {
    DeviceEffects chosen = effects;
    chosen.friction = chosen.quantisation = false;
    Bench bench(still_hand(0.0), chosen);
    bench.run(20, {10.0, 0.0, 0.0});
    return bench.joystick.position().x();
  };
  const double t = 0.020;
  // Without the grip's spring and damper, which have done little after 20 ms.
  EXPECT_NEAR(way({}), 0.5 * 10.0 / 1.3 * t * t, 0.08e-3);
  EXPECT_NEAR(way(all_but(&DeviceEffects::inertia)), 0.5 * 10.0 / 1.0 * t * t, 0.12e-3);
  EXPECT_GT(way(all_but(&DeviceEffects::inertia)), way({}) + 0.3e-3);
}

TEST(SimJoystick, StopsSoftlyOutsideItsTravel) {
  Bench bench(still_hand());
  bench.steer({0.2, 0.0, 0.0}, 0.5);
  bench.run(2000);
  EXPECT_GT(bench.sample.X_MH.p.x(), 0.100);
  EXPECT_LT(bench.sample.X_MH.p.x(), 0.106);
}

TEST(SimJoystick, ASteeredHandArrivesAlongAStraightLine) {
  Bench bench(still_hand());
  bench.steer({0.06, 0.03, 0.0});
  double off = 0.0, fastest = 0.0;
  while (bench.joystick.moving()) {
    bench.tick();
    const Vec2 p = bench.joystick.position();
    off = std::max(off, std::abs(p.x() - 2.0 * p.y()));
    fastest = std::max(fastest, bench.joystick.velocity().norm());
  }
  EXPECT_LT((bench.joystick.position() - Vec2(0.06, 0.03)).norm(), 0.1e-3);
  EXPECT_LT(off, 0.1e-3);
  EXPECT_NEAR(fastest, 1.875 * std::hypot(0.06, 0.03), 2e-3);
}

TEST(SimJoystick, AHandFollowsAGuidingBallRoundACircle) {
  Bench bench(joystick_grip(0.5, 5));
  const double radius = 0.05, rate = 2.0 * std::numbers::pi / 6.0;
  double worst = 0.0;
  bench.steer({radius, 0.0, 0.0});
  bench.run(2000);
  for (int i = 0; i < 12'000; ++i) {
    const double a = rate * i * 1e-3;
    const Vec2 ball(radius * std::cos(a), radius * std::sin(a));
    bench.joystick.follow(ball, radius * rate * Vec2(-std::sin(a), std::cos(a)));
    bench.tick();
    if (i > 3000) worst = std::max(worst, (bench.joystick.position() - ball).norm());
  }
  EXPECT_LT(worst, 8e-3);
}

TEST(SimJoystick, AgainstALoadTheHandPushesUntilItIsWithTheBall) {
  Bench bench(still_hand());
  for (int i = 0; i < 6000; ++i) {
    bench.joystick.follow({0.03, 0.0}, {0.0, 0.0});
    bench.tick({-8.0, 0.0, 0.0});
  }
  EXPECT_NEAR(bench.joystick.position().x(), 0.03, 1e-3);
  EXPECT_NEAR(bench.joystick.handle_force().x(), 8.0, 0.35) << "the load, but for dry friction";
  bench.steer({0.0, 0.0, 0.0});
  bench.run(1500);
  EXPECT_FALSE(bench.joystick.moving());
}

TEST(SimJoystick, AHandThatCannotFollowGivesUpGrowingItsPush) {
  Bench bench(still_hand());
  for (int i = 0; i < 20'000; ++i) {
    bench.joystick.follow({0.09, 0.0}, {0.0, 0.0});
    // A wall of 50 N/mm at 10 mm, past what the motor makes.
    bench.tick({-50e3 * std::max(bench.joystick.position().x() - 0.01, 0.0), 0.0, 0.0});
    ASSERT_LT(bench.joystick.handle_force().norm(), 350.0 * 0.1 + 60.0) << i;
  }
}

TEST(SimJoystick, ALimpHandStaysWhereItIsPushedUntilItFollowsAgain) {
  Bench bench(still_hand());
  for (int i = 0; i < 500; ++i) {
    bench.joystick.follow({0.0, 0.0}, {0.0, 0.0});
    bench.tick();
  }
  bench.joystick.let_go();
  bench.run(2000, {2.0, 0.0, 0.0});
  const double there = bench.joystick.position().x();
  EXPECT_GT(there, 0.03);
  bench.run(3000);
  EXPECT_NEAR(bench.joystick.position().x(), there, 0.01) << "a hand that holds on comes back";
  for (int i = 0; i < 4000; ++i) {
    bench.joystick.follow({0.0, 0.0}, {0.0, 0.0});
    bench.tick();
  }
  EXPECT_LT(bench.joystick.position().norm(), 2e-3);
}

TEST(SimJoystick, ALimpHandGivesBackNoEnergyAtAnyFrequency) {
  DeviceEffects effects;
  effects.quantisation = effects.friction = false;
  for (const double grip : {0.0, 0.5, 1.0}) {
    for (const double mass : {0.5, 1.5}) {
      for (const double rate : {0.5, 1.0, 1.9, 3.0, 6.0, 12.0}) {
        HandOptions hand = still_hand(grip);
        const double damping = hand.damping_ratio * std::sqrt(hand.stiffness * hand.mass);
        hand.mass = mass;
        hand.damping_ratio = damping / std::sqrt(hand.stiffness * mass);
        Bench bench(hand, effects);
        bench.joystick.let_go();
        double work = 0.0;  // of the motors, over the last of 20 s
        for (int i = 0; i < 20'000; ++i) {
          const double f = std::sin(2.0 * std::numbers::pi * rate * 1e-3 * (i + 0.5));
          const double before = bench.joystick.position().x();
          bench.tick({f, 0.0, 0.0});
          if (i >= 10'000) work += f * (bench.joystick.position().x() - before);
        }
        EXPECT_GT(work, 0.0) << "grip " << grip << ", " << mass << " kg, " << rate << " Hz";
      }
    }
  }
}

// Newton on the device alone: m x'' = motor + handle - friction, summed over each tick.
TEST(SimJoystick, HandleForceIsWhatMovesTheDevice) {
  DeviceEffects effects;
  effects.quantisation = effects.friction = false;
  Bench bench(joystick_grip(0.3, 9), effects);
  bench.steer({0.05, 0.02, 0.0});
  Random random(4);
  Vec2 v = bench.joystick.velocity();
  for (int i = 0; i < 2000; ++i) {
    const Vec2 motor(3.0 * random.normal(), 3.0 * random.normal());
    bench.tick({motor.x(), motor.y(), 0.0});
    const Vec2 now = bench.joystick.velocity();
    const Vec2 expected = kJoystickMass * (now - v) / 1e-3 - motor;
    EXPECT_LT((bench.joystick.handle_force() - expected).norm(), 1e-6) << i;
    v = now;
  }
}

TEST(SimJoystick, ARecordedHandMeansToGoWhereItWentAndFeelsForces) {
  std::vector<RecordedSample> samples;
  for (int i = 0; i <= 100; ++i) samples.push_back({0.02 * i, Vec3(1e-3 * i, 0.0, 1e-3 * i)});
  const RecordedMotion motion(samples);
  Bench free(still_hand(), {}, motion), pushed(still_hand(), {}, motion);
  EXPECT_NEAR(free.sample.X_MH.p.x(), -0.05, kCount);
  for (int i = 0; i < 1500; ++i) {
    free.tick();
    pushed.tick({0.0, 7.0, 0.0});
  }
  EXPECT_NEAR(free.sample.X_MH.p.x(), 0.025, 0.5e-3);
  EXPECT_EQ(free.sample.X_MH.p.z(), 0.0);
  EXPECT_NEAR(pushed.sample.X_MH.p.y() - free.sample.X_MH.p.y(), 7.0 / 350.0, 1.5e-3);
}

TEST(SimJoystick, EffectsCanChangeWhileItRuns) {
  Bench bench(still_hand());
  bench.steer({0.05, 0.0, 0.0});
  bench.run(500);
  const Vec2 before = bench.joystick.position();
  DeviceEffects none;
  none.inertia = none.friction = none.quantisation = none.force_limits = false;
  bench.joystick.simulate(none, Vec3::Zero());
  EXPECT_EQ(bench.joystick.position(), before);
  bench.tick();
  EXPECT_EQ(bench.sample.X_MH.p.x(), bench.joystick.position().x());
  EXPECT_LT((bench.joystick.position() - before).norm(), 0.2e-3);
}

}  // namespace
}  // namespace handrail
