// What the default bumper keeps for any surface, force and command.
#include <gtest/gtest.h>

#include "server/follow/bumper.h"
#include "tests/unit/constraint/tool_samples.h"

namespace handrail {
namespace {

using test::Dice;

struct Walk {
  BumperSettings settings;
  BumperState state;
  BumperInput in;

  explicit Walk(Dice& dice) {
    settings.friction = dice.between(0.0, 0.8);
    settings.noise = dice.between(0.0, 1.0) < 0.5 ? 0.0 : 2.0;
    settings.promise = dice.between(0.0, 1.0) < 0.5 ? 0.0 : 200.0;
    settings.sensor_lag = dice.between(0.0, 0.12);
    in.delay = dice.between(0.0, 0.1);
  }
  // A force on a surface of normal `n`, within its friction cone.
  Vec3 force(Dice& dice, const Vec3& n) const {
    const double normal = std::pow(10.0, dice.between(-1.0, 3.0));
    const Vec3 t = n.unitOrthogonal(), s = n.cross(t);
    const double turn = dice.between(-3.14, 3.14), share = dice.between(0.0, settings.friction);
    return normal * (n + share * (std::cos(turn) * t + std::sin(turn) * s));
  }
};

TEST(BumperProperty, NoStepGoesIntoAnySurfaceThatTheForceAboveTheThresholdMayBeOf) {
  Dice dice(71);
  int judged = 0;
  for (int walk = 0; walk < 3000; ++walk) {
    Walk w(dice);
    Vec3 n = dice.unit();
    for (int i = 0; i < 200; ++i) {
      if (dice.between(0.0, 1.0) < 0.05) n = dice.unit();
      w.in.f_E_S = dice.between(0.0, 1.0) < 0.1 ? Vec3::Zero() : w.force(dice, n);
      w.in.fresh = dice.between(0.0, 1.0) > 0.05;
      w.in.p_SU = w.in.p_last + std::pow(10.0, dice.between(-6.0, -1.0)) * dice.unit();
      w.in.p_ST = w.in.p_last + dice.within(1e-3);
      const Vec3 step = bump(w.settings, w.in, w.state).p_SB - w.in.p_last;
      ASSERT_TRUE(step.allFinite());
      if (w.in.f_E_S.norm() > w.settings.threshold) {
        ++judged;
        ASSERT_GE(step.dot(n), -1e-12) << walk << ' ' << i;
      }
      if (dice.between(0.0, 1.0) < 0.9) w.in.p_last += step;
    }
  }
  EXPECT_GT(judged, 100000);
}

TEST(BumperProperty, AnythingFiniteGivesSomethingFinite) {
  Dice dice(72);
  for (int walk = 0; walk < 2000; ++walk) {
    Walk w(dice);
    w.settings.threshold = std::pow(10.0, dice.between(-1.0, 3.0));
    w.settings.alpha = dice.between(0.0, 1e-3);
    const auto any = [&](double most) {
      return Vec3(most * std::pow(10.0, dice.between(-20.0, 0.0)) * dice.unit());
    };
    for (int i = 0; i < 100; ++i) {
      w.in.f_E_S = any(1e6);
      w.in.p_SU = any(1e3);
      w.in.p_last = any(1e3);
      w.in.p_ST = any(1e3);
      ASSERT_TRUE(bump(w.settings, w.in, w.state).p_SB.allFinite());
      ASSERT_NEAR(w.state.n_S.norm(), 1.0, 1e-9);
      ASSERT_LE(w.state.stiffness, w.settings.stiffest);
    }
  }
}

TEST(BumperProperty, MoreForceNeverAllowsMoreInward) {
  Dice dice(73);
  for (int i = 0; i < 20000; ++i) {
    Walk w(dice);
    const Vec3 n = dice.unit();
    w.in.f_E_S = 60.0 * n;
    bump(w.settings, w.in, w.state);
    w.in.p_last = w.in.p_ST = -dice.between(0.0, 5e-3) * n;
    w.in.p_SU = w.in.p_last - dice.between(0.0, 0.02) * n;
    const double less = dice.between(0.0, 200.0), more = dice.between(less, 400.0);
    BumperState other = w.state;
    w.in.f_E_S = less * n;
    const double step = (bump(w.settings, w.in, w.state).p_SB - w.in.p_last).dot(n);
    w.in.f_E_S = more * n;
    ASSERT_GE((bump(w.settings, w.in, other).p_SB - w.in.p_last).dot(n), step - 1e-12);
  }
}

// In free air under noise of 2 N a command passes bit for bit, for an hour of cycles.
TEST(BumperProperty, NoiseIsNoContact) {
  Dice dice(74);
  Walk w(dice);
  w.settings.promise = 0.0;
  const auto normal = [&] {
    double sum = 0.0;  // of twelve uniform ones: variance 1
    for (int i = 0; i < 12; ++i) sum += dice.between(-0.5, 0.5);
    return 2.0 * sum;
  };
  for (int i = 0; i < 507042; ++i) {
    w.in.f_E_S = {normal(), normal(), normal()};
    w.in.p_SU = dice.within(0.5);
    ASSERT_EQ(bump(w.settings, w.in, w.state).p_SB, w.in.p_SU);
  }
}

}  // namespace
}  // namespace handrail
