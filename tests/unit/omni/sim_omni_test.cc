#include "devices/omni/sim_omni.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "server/base/units.h"

namespace handrail {
namespace {

HandOptions still_hand() {
  HandOptions options;
  options.tremor_rms = 0.0;
  options.drift_rms = 0.0;
  options.drift_rotation_rms = 0.0;
  options.reaction = 0.0;
  return options;
}

// A device read once a millisecond.
class Bench {
 public:
  explicit Bench(const HandOptions& hand, bool torque = false) : omni_(hand, torque) {
    EXPECT_TRUE(omni_.open().is_ok());
    sample_ = omni_.read(now_);
  }

  const HapticSample& tick(const Wrench& wrench = {}) {
    omni_.write(wrench);
    now_ += kMillisecond;
    return sample_ = omni_.read(now_);
  }
  const HapticSample& run(int ticks, const Wrench& wrench = {}) {
    for (int i = 0; i < ticks; ++i) tick(wrench);
    return sample_;
  }
  void steer(const Vec3& displacement, double duration) {
    HandIntent intent;
    intent.displacement_M = displacement;
    intent.duration = duration;
    omni_.hand()->steer(intent);
  }
  SimOmni& omni() { return omni_; }
  const HapticSample& sample() const { return sample_; }

 private:
  SimOmni omni_;
  Nanos now_ = 5 * kSecond;
  HapticSample sample_;
};

Wrench force(double x, double y, double z) { return {Vec3(x, y, z), Vec3::Zero()}; }

TEST(SimOmni, ReadsPositionsInStepsOfItsResolution) {
  Bench bench(HandOptions{});
  bool moved = false;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 steps = bench.tick().X_MH.p / 0.055e-3;
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(steps[axis], std::round(steps[axis]), 1e-6);
    moved = moved || steps.norm() > 2.0;
  }
  EXPECT_TRUE(moved);
}

TEST(SimOmni, HomeIsWhereTheHandBegan) {
  Bench bench(still_hand());
  const Pose began = bench.run(100).X_MH;
  HandIntent away;
  away.displacement_M = Vec3(0.03, -0.02, 0.01);
  away.rotation_M = Vec3(0.0, 0.4, 0.0);
  bench.omni().hand()->steer(away);
  ASSERT_GT((bench.run(2500).X_MH.p - began.p).norm(), 0.03);
  HandIntent home;
  home.home = true;
  bench.omni().hand()->steer(home);
  const Pose back = bench.run(4000).X_MH;
  EXPECT_LT((back.p - began.p).norm(), 0.2e-3);
  EXPECT_LT(angle_between(back.q, began.q), 0.01);
  EXPECT_FALSE(bench.omni().hand()->moving());
}

TEST(SimOmni, SaturatesAtItsPeakForce) {
  Bench peak(still_hand());
  Bench beyond(still_hand());
  Bench far_beyond(still_hand());
  peak.run(2000, force(0.0, 3.3, 0.0));
  beyond.run(2000, force(0.0, 40.0, 0.0));
  far_beyond.run(2000, force(0.0, 1e200, 0.0));
  EXPECT_EQ(peak.sample().X_MH.p, beyond.sample().X_MH.p);
  EXPECT_EQ(peak.sample().X_MH.p, far_beyond.sample().X_MH.p);
  EXPECT_NEAR(peak.sample().X_MH.p.y(), 3.3 / 250.0, 0.26 / 250.0 + 0.055e-3);
}

TEST(SimOmni, BackDriveFrictionSwallowsASmallForce) {
  Bench bench(still_hand());
  EXPECT_EQ(bench.run(2000, force(0.2, 0.0, 0.0)).X_MH.p, Vec3::Zero());
  EXPECT_GT(bench.run(2000, force(0.6, 0.0, 0.0)).X_MH.p.x(), 1e-3);
}

TEST(SimOmni, FollowsASteeredHandAndReportsItsSpeed) {
  Bench bench(still_hand());
  bench.steer({0.06, 0.0, 0.0}, 1.0);
  EXPECT_TRUE(bench.omni().hand()->moving());
  double peak = 0.0;
  for (int i = 0; i < 1500; ++i) peak = std::max(peak, bench.tick().v_MH.x());
  EXPECT_FALSE(bench.omni().hand()->moving());
  EXPECT_NEAR(bench.sample().X_MH.p.x(), 0.06, 0.1e-3);
  // One count a millisecond is 55 mm/s; the filter leaves some of it.
  EXPECT_NEAR(peak, 1.875 * 0.06, 0.010);
  EXPECT_LT(bench.sample().v_MH.norm(), 1e-6);
}

TEST(SimOmni, VelocityIsTheLowPassedDifferenceOfReadings) {
  Bench bench(HandOptions{});
  bench.steer({0.03, 0.02, 0.0}, 0.5);
  const double follow = 1.0 - std::exp(-2.0 * 3.14159265358979 * 30.0 * 1e-3);
  Vec3 expected = bench.sample().v_MH;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 before = bench.sample().X_MH.p;
    bench.tick();
    expected += follow * ((bench.sample().X_MH.p - before) / 1e-3 - expected);
    EXPECT_LT((bench.sample().v_MH - expected).norm(), 1e-9);
  }
  EXPECT_GT(expected.norm() + bench.sample().X_MH.p.norm(), 1e-3);
}

TEST(SimOmni, StopsSoftlyOutsideTheNominalWorkSpace) {
  Bench bench(still_hand());
  bench.steer({0.0, 0.0, 0.2}, 0.5);
  const HapticSample sample = bench.run(2000);
  EXPECT_GT(sample.X_MH.p.z(), 0.035);
  EXPECT_LT(sample.X_MH.p.z(), 0.055);
}

TEST(SimOmni, OnlyTheTorqueVariantFeelsTorque) {
  Bench plain(still_hand());
  Bench torque(still_hand(), true);
  const Wrench turn{Vec3::Zero(), Vec3(0.0, 0.0, 5.0)};
  EXPECT_LT(angle_between(plain.run(2000, turn).X_MH.q, Quat::Identity()), 1e-12);
  // 0.2 N m, the saturation, against 1 N m/rad.
  EXPECT_NEAR(angle_between(torque.run(2000, turn).X_MH.q, Quat::Identity()), 0.2, 1e-5);
  EXPECT_FALSE(plain.omni().capabilities().actuates_torque);
  EXPECT_TRUE(torque.omni().capabilities().actuates_torque);
}

// Inertia and damping of hand and stylus: 2e-4 + m l^2 / 12 and 1.4 sqrt(2e-4) + 5e-4, under
// 0.1 N m against 1 N m/rad; its period and its decay are those of the closed form.
TEST(SimOmni, TheStylusTurnsWithItsOwnInertiaAndDamping) {
  Bench bench(still_hand(), true);
  bench.run(1);
  const double inertia = 2e-4 + kOmniMass * 0.15 * 0.15 / 12.0;
  const double damping = 1.4 * std::sqrt(2e-4) + 5e-4;
  const double decay = damping / (2.0 * inertia);
  const double w = std::sqrt(1.0 / inertia - decay * decay);
  double worst = 0.0;
  for (int i = 1; i <= 100; ++i) {
    const HapticSample sample = bench.run(1, {Vec3::Zero(), Vec3(0.0, 0.1, 0.0)});
    const double t = 1e-3 * i;
    const double turned =
        0.1 * (1.0 - std::exp(-decay * t) * (std::cos(w * t) + decay / w * std::sin(w * t)));
    worst = std::max(worst, std::abs(angle_between(sample.X_MH.q, Quat::Identity()) - turned));
  }
  EXPECT_LT(worst, 1.5e-3) << "steps of 0.25 ms, of first order";
}

// In a hand that does not damp, it swings out by b / 2 J = 0.88 a second and by w^2 h / 2 = 0.44,
// which implicit steps of h = 0.25 ms take.
TEST(SimOmni, TheStylusDampsItsOwnTurning) {
  HandOptions options = still_hand();
  options.rotation_damping_ratio = 0.0;
  Bench bench(options, true);
  bench.run(50, {Vec3::Zero(), Vec3(0.0, 0.1, 0.0)});
  const auto widest = [&bench] {
    double out = 0.0;
    for (int i = 0; i < 200; ++i)
      out = std::max(out, angle_between(bench.run(1).X_MH.q, Quat::Identity()));
    return out;
  };
  const double before = widest();
  bench.run(800);
  EXPECT_NEAR(widest() / before, std::exp(-0.88 - 0.44), 0.03);
}

TEST(SimOmni, OrientationFollowsTheIntent) {
  Bench bench(still_hand());
  HandIntent intent;
  intent.rotation_M = Vec3(0.0, 45.0 * kDeg, 0.0);
  intent.buttons = 2;
  bench.omni().hand()->steer(intent);
  EXPECT_EQ(bench.run(500).buttons, 2u);
  const HapticSample sample = bench.run(600);
  EXPECT_LT(angle_between(sample.X_MH.q, rotation_exp(intent.rotation_M)), 1e-9);
  EXPECT_EQ(sample.buttons, 0u);
}

// The virtual tool's stiffness on quantised readings, against firm and light grips.
TEST(SimOmni, AHardVirtualSpringNeitherDivergesNorBuzzes) {
  for (const double stiffness : {250.0, 50.0}) {
    HandOptions options = still_hand();
    options.stiffness = stiffness;
    Bench bench(options);
    bench.steer({0.03, 0.01, 0.0}, 0.3);
    double late_low = 1.0;
    double late_high = -1.0;
    for (int i = 0; i < 6000; ++i) {
      const Vec3 f = -800.0 * bench.sample().X_MH.p;
      bench.tick({f, Vec3::Zero()});
      EXPECT_LT(bench.sample().X_MH.p.norm(), 0.033);
      if (i < 5000) continue;
      late_low = std::min(late_low, bench.sample().X_MH.p.x());
      late_high = std::max(late_high, bench.sample().X_MH.p.x());
    }
    EXPECT_LT(late_high - late_low, 1.5 * 0.055e-3) << stiffness;
  }
}

TEST(SimOmni, AnyHandAConfigurationAllowsStaysBounded) {
  for (const double mass : {0.01, 5.0}) {
    for (const double stiffness : {10.0, 5000.0}) {
      for (const double damping_ratio : {0.0, 5.0}) {
        HandOptions options;
        options.mass = mass;
        options.stiffness = stiffness;
        options.damping_ratio = damping_ratio;
        Bench bench(options);
        bench.steer({0.05, 0.0, 0.0}, 0.2);
        for (int i = 0; i < 5000; ++i) {
          // Pushes to and fro at 4 Hz, as hard as the device can.
          bench.tick(force(i / 125 % 2 == 0 ? 3.3 : -3.3, 0.0, 1.0));
          ASSERT_LT(bench.sample().X_MH.p.norm(), 0.15)
              << mass << " kg, " << stiffness << " N/m, " << damping_ratio << ", tick " << i;
        }
      }
    }
  }
}

TEST(SimOmni, ALongStallCostsBoundedWork) {
  SimOmni stalled(still_hand(), false);
  ASSERT_TRUE(stalled.open().is_ok());
  stalled.read(0);
  HandIntent intent;
  intent.displacement_M = Vec3(0.02, 0.0, 0.0);
  intent.duration = 2.0;
  stalled.hand()->steer(intent);
  const HapticSample sample = stalled.read(3600 * kSecond);
  // Half way: the model advanced by one second only.
  EXPECT_NEAR(sample.X_MH.p.x(), 0.01, 0.1e-3);
  EXPECT_TRUE(stalled.hand()->moving());
}

}  // namespace
}  // namespace handrail
