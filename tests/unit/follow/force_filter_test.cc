// The low pass of the contact force, by itself and in the slave's step.
#include "server/follow/force_filter.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/follow/follow_rig.h"

namespace handrail {
namespace {

using test::FollowRig;

constexpr double kFilterCycle = 0.0071;

TEST(ForceFilter, ARiseIsSeenLateByTheLagWhateverTheCycle) {
  for (const double dt : {0.001, kFilterCycle, 0.05}) {
    for (const double lag : {0.002, 0.02, 0.05}) {
      ForceFilter filter;
      Vec3 seen = Vec3::Zero();
      const int cycles = static_cast<int>(40.0 * (lag + dt) / dt);
      for (int i = 0; i <= cycles; ++i) seen = filter.pass(Vec3(i * dt, 0, -2.0 * i * dt), lag, dt);
      EXPECT_NEAR(cycles * dt - seen.x(), lag, 1e-9) << dt << ' ' << lag;
      EXPECT_NEAR(seen.z(), -2.0 * seen.x(), 1e-12);
    }
  }
}

TEST(ForceFilter, NoLagPassesEveryBit) {
  ForceFilter filter;
  for (const double v : {1.0, -0.0, 1e-300, 7.1, -3.3}) {
    const Vec3& out = filter.pass(Vec3(v, 0.1 * v, -v), 0.0, kFilterCycle);
    EXPECT_EQ(out, Vec3(v, 0.1 * v, -v));
    EXPECT_EQ(std::signbit(out.x()), std::signbit(v));
  }
}

TEST(ForceFilter, TakesOutNoiseAsTheoryHasIt) {
  // White noise through y += b (x - y): variance b / (2 - b).
  ForceFilter filter;
  const double lag = 0.02, b = kFilterCycle / (lag + kFilterCycle);
  std::uint64_t state = 1;
  double squares = 0.0;
  constexpr int kReadings = 200'000;
  for (int i = 0; i < kReadings; ++i) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    const double white = static_cast<double>(state >> 11) / 4503599627370496.0 - 1.0;  // +-1
    squares += std::pow(filter.pass(Vec3(white, 0, 0), lag, kFilterCycle).x(), 2);
  }
  EXPECT_NEAR(squares / kReadings, b / (2.0 - b) / 3.0, 0.004);
}

class FollowFilter : public ::testing::Test {
 protected:
  FollowFilter() {
    rig.settings.force_lag = 0.02;
    rig.settings.sensor_range = 100.0;
  }
  // The size of what is felt after a cycle with this reading.
  double felt(double newtons) {
    rig.in.f_E_T.force = {newtons, 0, 0};
    rig.cycle();
    return rig.out.link.f_E_S.force.norm();
  }
  FollowRig rig;
  const double b = rig.settings.motion->dt / (0.02 + rig.settings.motion->dt);
};

TEST_F(FollowFilter, TheFirstReadingIsFeltAtOnceAndTheNextBySteps) {
  EXPECT_NEAR(felt(10.0), 10.0, 1e-12);
  EXPECT_NEAR(felt(20.0), 10.0 + b * 10.0, 1e-12);
  EXPECT_NEAR(felt(20.0), 20.0 - (1.0 - b) * (1.0 - b) * 10.0, 1e-12);
}

TEST_F(FollowFilter, ARejectedReadingDoesNotEnter) {
  felt(10.0);
  EXPECT_NEAR(felt(101.0), 10.0, 1e-12) << "out of range as it is, filtered it would not be";
  EXPECT_FALSE(rig.out.link.has_wrench);
  EXPECT_NEAR(felt(std::numeric_limits<double>::quiet_NaN()), 10.0, 1e-12);
  EXPECT_NEAR(felt(20.0), 10.0 + b * 10.0, 1e-12);
  EXPECT_TRUE(rig.out.link.has_wrench);
}

TEST_F(FollowFilter, AfterALossItBeginsWithTheFirstReading) {
  felt(10.0);
  rig.in.wrench_valid = false;
  for (int i = 0; i < 3; ++i) felt(10.0);
  EXPECT_EQ(felt(10.0), 0.0);
  rig.in.wrench_valid = true;
  EXPECT_NEAR(felt(30.0), 30.0, 1e-12);
}

TEST_F(FollowFilter, ThePayloadIsTakenOutBeforeIt) {
  // Turned from one cycle to the next, the weight is gone at once: nothing of it lingers.
  rig.settings.payload.mass = 2.0;
  for (const double turn : {0.0, 60.0, -60.0}) {
    const JointVector q = test::home() + test::joints_deg(0, 0, 0, 0, 0.4 * turn, turn);
    place(rig.settings, q, rig.state);
    rig.in.q_measured = q;
    rig.in.f_E_T.force = forward(rig.settings.motion->arm, q).q.toRotationMatrix().transpose() *
                         Vec3(0, 0, -2.0 * 9.80665);
    rig.cycle();
    EXPECT_LT(rig.out.link.f_E_S.force.norm(), 1e-9);
  }
}

}  // namespace
}  // namespace handrail
