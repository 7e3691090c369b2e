// The parts of the 2-DOF joystick that need no card.
#include <gtest/gtest.h>

#include "devices/comedi/encoder_count.h"
#include "devices/comedi/joystick_force.h"
#include "devices/comedi/joystick_homing.h"

namespace handrail {
namespace {

TEST(EncoderCount, GoesOnWhereTheCounterBeginsAnew) {
  EncoderCount count;
  count.begin(0xfffffe, 0xffffff);
  EXPECT_EQ(count.next(0xffffff), 1);
  EXPECT_EQ(count.next(3), 5);
  EXPECT_EQ(count.next(0xfffff0), -14);
  count.begin(5, 0xffffffff);
  EXPECT_EQ(count.next(0xfffffffb), -10);
  EXPECT_EQ(count.next(0), -5);
}

TEST(JoystickHoming, TheMiddleIsBetweenTheStops) {
  JoystickHoming homing(StickHoming::kStops, 0.2);
  EXPECT_FALSE(homing.step({0.0, 0.0}));
  EXPECT_FALSE(homing.step({0.05, 0.03}));
  EXPECT_FALSE(homing.step({-0.148, 0.0}));  // 198 mm: both stops, of one motor
  EXPECT_TRUE(homing.reached(0));
  EXPECT_FALSE(homing.reached(1));
  EXPECT_FALSE(homing.step({0.0, -0.16}));
  EXPECT_TRUE(homing.step({0.0, -0.17}));
  EXPECT_NEAR(homing.middle()[0], -0.049, 1e-12);
  EXPECT_NEAR(homing.middle()[1], -0.07, 1e-12);
  // What comes later does not shift the hand.
  EXPECT_TRUE(homing.step({0.06, -0.17}));
  EXPECT_NEAR(homing.middle()[0], -0.049, 1e-12);
  EXPECT_FALSE(homing.too_far());
  EXPECT_TRUE(homing.step({0.08, -0.17}));  // 228 mm
  EXPECT_TRUE(homing.too_far());
}

TEST(JoystickHoming, OneThatStandsInItsMiddleIsHomedAtOnce) {
  JoystickHoming homing(StickHoming::kCentre, 0.2);
  EXPECT_TRUE(homing.step({0.01, -0.02}));
  EXPECT_EQ(homing.middle(), (StickWays{0.01, -0.02}));
}

class JoystickForceTest : public ::testing::Test {
 protected:
  Vec2 go(const Vec2& asked, double seconds, bool allowed = true) {
    Vec2 out = Vec2::Zero();
    for (int i = 0; i < static_cast<int>(1e3 * seconds + 0.5); ++i) {
      now += kMillisecond;
      out = force.step(asked, now, allowed, now, kMillisecond);
    }
    return out;
  }
  JoystickForce force{100.0};
  Nanos now = kSecond;
};

TEST_F(JoystickForceTest, ComesWithinHalfASecond) {
  EXPECT_NEAR(go({4.0, -2.0}, 0.1).x(), 0.8, 1e-9);
  EXPECT_NEAR(go({4.0, -2.0}, 0.15).y(), -1.0, 1e-9);
  EXPECT_EQ(go({4.0, -2.0}, 0.3), Vec2(4.0, -2.0));
}

TEST_F(JoystickForceTest, IsGoneFiftyMillisecondsAfterTheLastWordAndComesBackSlowly) {
  go({4.0, 0.0}, 1.0);
  const Nanos asked = now;
  EXPECT_EQ(force.step({4.0, 0.0}, asked, true, asked + 50 * kMillisecond, kMillisecond).x(), 4.0);
  EXPECT_EQ(force.step({4.0, 0.0}, asked, true, asked + 51 * kMillisecond, kMillisecond).x(), 0.0);
  now += kSecond;
  EXPECT_NEAR(go({4.0, 0.0}, 0.1).x(), 0.8, 1e-9);
}

TEST_F(JoystickForceTest, NeitherWhereItIsNotAllowedNorWhereItIsNoNumber) {
  go({4.0, 0.0}, 1.0);
  EXPECT_EQ(go({4.0, 0.0}, 0.001, false), Vec2(0.0, 0.0));
  EXPECT_NEAR(go({4.0, 0.0}, 0.1).x(), 0.8, 1e-9);
  EXPECT_EQ(go({std::nan(""), 1.0}, 0.001), Vec2(0.0, 0.0));
}

// 3.8 N m at 15 cm are 25.3 N; 1.27 N m are 8.5 N.
TEST_F(JoystickForceTest, IsNeverAboveThePeakAndForLongNotAboveWhatTheMotorsSustain) {
  EXPECT_NEAR(go({1000.0, -1000.0}, 0.5).x(), 25.33, 0.01);
  EXPECT_NEAR(go({1000.0, -1000.0}, 0.1).y(), -25.33, 0.01);
  // 25.3 squared reaches the rated square after 10 s * ln(1 / (1 - (8.47/25.33)^2)) = 1.18 s.
  EXPECT_FALSE(force.hot());
  EXPECT_NEAR(go({1000.0, 0.0}, 1.0).x(), 8.47, 0.01);
  EXPECT_TRUE(force.hot());
  EXPECT_NEAR(go({1000.0, 0.0}, 60.0).x(), 8.47, 0.01);
  go({0.0, 0.0}, 10.0);
  EXPECT_FALSE(force.hot());
  EXPECT_NEAR(go({8.0, 8.0}, 100.0).x(), 8.0, 1e-9);
  EXPECT_FALSE(force.hot());
}

TEST(JoystickForce, KeepsToWhatIsConfigured) {
  JoystickForce weak(2.0);
  Vec2 out = Vec2::Zero();
  for (Nanos now = kSecond; now < 2 * kSecond; now += kMillisecond) {
    out = weak.step({9.0, -9.0}, now, true, now, kMillisecond);
  }
  EXPECT_EQ(out, Vec2(2.0, -2.0));
}

}  // namespace
}  // namespace handrail
