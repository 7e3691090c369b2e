// The simulated sensor on the handle tells what the simulated hand does, not what was asked for.
#include "devices/hand/sim_handle_sensor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "devices/joystick/joystick_data.h"
#include "devices/joystick/sim_joystick.h"
#include "devices/omni/sim_omni.h"

namespace handrail {
namespace {

HandOptions still_hand() {
  HandOptions hand = joystick_grip();
  hand.tremor_rms = hand.drift_rms = hand.drift_rotation_rms = 0.0;
  return hand;
}

// The mean push of the hand in the second after the force has acted for one.
Vec3 mean_push(HapticDevice& device, const Vec3& force) {
  EXPECT_TRUE(device.open());
  Vec3 sum = Vec3::Zero();
  int count = 0;
  for (Nanos now = 0; now < 2 * kSecond; now += kMillisecond) {
    (void)device.read(now);
    device.write({force, Vec3::Zero()});
    if (now < kSecond) continue;
    sum += device.simulated_push().value_or(Vec3::Constant(1e9));
    ++count;
  }
  return sum / count;
}

TEST(SimHandleSensor, TheHandHoldsAgainstTheForceLessTheFrictionOfTheJoystick) {
  SimJoystick device(still_hand(), DeviceEffects{});
  const Vec3 push = mean_push(device, Vec3(5.0, 0.0, 0.0));
  // At rest friction takes some of the force, either way, and no more than there is.
  EXPECT_NEAR(push.x(), -5.0, kJoystickFriction + 1e-3);
  EXPECT_NE(push.x(), -5.0);
  EXPECT_NEAR(push.y(), 0.0, 1e-3);
}

TEST(SimHandleSensor, WithoutFrictionTheHandFeelsWhatIsAskedFor) {
  SimJoystick device(still_hand(), DeviceEffects{false, false, false, false});
  EXPECT_NEAR(mean_push(device, Vec3(0.0, -3.0, 0.0)).y(), 3.0, 0.01);
}

TEST(SimHandleSensor, BeyondItsPeakTheDevicePushesNoHarder) {
  SimOmni device(HandOptions{}, false);
  const double push = mean_push(device, Vec3(10.0, 0.0, 0.0)).x();
  EXPECT_NEAR(push, -device.capabilities().max_force, kOmniFriction + 0.1);
}

// A loop's turns are not a millisecond to the nanosecond: what is left of one is no step to divide
// by.
TEST(SimHandleSensor, TremorIsNoBlowWhenTurnsAreUneven) {
  HandOptions hand = joystick_grip();
  hand.tremor_rms = 0.05e-3;
  hand.drift_rms = 0.97e-3;
  SimJoystick joystick(hand);
  SimOmni omni(HandOptions{}, false);
  for (HapticDevice* device :
       {static_cast<HapticDevice*>(&joystick), static_cast<HapticDevice*>(&omni)}) {
    ASSERT_TRUE(device->open());
    double most = 0.0;
    Nanos now = 0;
    for (int i = 0; i < 3000; ++i) {
      now += kMillisecond + (i * 7919) % 3000 - 1000;  // from -1 to 2 us late
      (void)device->read(now);
      most = std::max(most, device->simulated_push()->norm());
    }
    EXPECT_LT(most, 5.0) << device->capabilities().name;
  }
}

TEST(SimHandleSensor, GivesTheNewestAndTellsWhatIsNoForce) {
  SimHandleSensor sensor;
  FtSample sample;
  EXPECT_FALSE(sensor.poll(0, sample));
  sensor.feel(Vec3(1.0, 0.0, 0.0));
  sensor.feel(Vec3(2.0, 0.0, 0.0));
  ASSERT_TRUE(sensor.poll(1, sample));
  EXPECT_EQ(sample.wrench.force.x(), 2.0);
  EXPECT_EQ(sample.sequence, 2u);
  EXPECT_EQ(sample.status, 0u);
  EXPECT_FALSE(sensor.poll(2, sample));
  sensor.feel(Vec3::Constant(std::numeric_limits<double>::quiet_NaN()));
  ASSERT_TRUE(sensor.poll(3, sample));
  EXPECT_NE(sample.status, 0u);
  EXPECT_TRUE(sample.wrench.force.isZero(0.0));
}

}  // namespace
}  // namespace handrail
