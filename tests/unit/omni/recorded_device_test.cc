#include "devices/omni/recorded_device.h"

#include <gtest/gtest.h>

namespace handrail {
namespace {

RecordedMotion slide() {
  return RecordedMotion({{3.0, Vec3(0.00, 0.01, 0.0)},
                         {3.1, Vec3(0.01, 0.01, 0.0)},
                         {3.2, Vec3(0.02, 0.01, 0.0)},
                         {3.3, Vec3(0.03, 0.01, 0.0)}});
}

TEST(RecordedDevice, StartsAtTheFirstSampleWheneverItIsFirstRead) {
  RecordedDevice device(slide());
  ASSERT_TRUE(device.open().is_ok());
  const HapticSample first = device.read(77 * kSecond);
  ASSERT_TRUE(first.valid);
  EXPECT_LT((first.X_MH.p - Vec3(-0.015, 0.0, 0.0)).norm(), 1e-12);
  const HapticSample later = device.read(77 * kSecond + 150 * kMillisecond);
  EXPECT_NEAR(later.X_MH.p.x(), 0.0, 1e-9);
  EXPECT_NEAR(later.v_MH.x(), 0.1, 1e-6);
  EXPECT_EQ(later.X_MH.q.coeffs(), Quat::Identity().coeffs());
}

TEST(RecordedDevice, FeelsNoForceAndHasNoHandToSteer) {
  RecordedDevice pushed(slide());
  RecordedDevice free(slide());
  ASSERT_TRUE(pushed.open().is_ok());
  ASSERT_TRUE(free.open().is_ok());
  for (Nanos t = 0; t < kSecond; t += kMillisecond) {
    pushed.write({Vec3(3.0, 3.0, 3.0), Vec3::Zero()});
    EXPECT_EQ(pushed.read(t).X_MH.p, free.read(t).X_MH.p);
  }
  EXPECT_EQ(pushed.hand(), nullptr);
}

TEST(RecordedDevice, RestsOnTheLastSampleAndPlaysAgainAfterOpening) {
  RecordedDevice device(slide());
  ASSERT_TRUE(device.open().is_ok());
  device.read(0);
  EXPECT_NEAR(device.read(10 * kSecond).X_MH.p.x(), 0.015, 1e-12);
  EXPECT_EQ(device.read(11 * kSecond).v_MH, Vec3::Zero());
  device.close();
  EXPECT_FALSE(device.read(12 * kSecond).valid);
  ASSERT_TRUE(device.open().is_ok());
  EXPECT_NEAR(device.read(13 * kSecond).X_MH.p.x(), -0.015, 1e-12);
}

}  // namespace
}  // namespace handrail
