#include "devices/page/page_device.h"

#include <gtest/gtest.h>

#include <limits>

#include "devices/page/page_data.h"
#include "server/base/units.h"
#include "tests/support/no_allocation.h"

namespace handrail {
namespace {

constexpr std::uint32_t kHeld = 4;
constexpr Nanos kFrame = 16 * kMillisecond;  // between two cursors

class PageDeviceTest : public ::testing::Test {
 protected:
  PageDeviceTest() {
    EXPECT_TRUE(device.open().is_ok());
    device.read(now);
  }
  void point(const Vec3& at, std::uint32_t buttons = kHeld, const Quat& turn = Quat::Identity()) {
    CursorSample cursor;
    cursor.sequence = ++sent;
    cursor.X_MC = {at, turn};
    cursor.buttons = buttons;
    cursor.at = now;
    device.lead(cursor);
  }
  // Ticks of a millisecond under `force` of the device on the hand, with a cursor in each frame.
  HapticSample hold(const Vec3& at, Nanos time, const Vec3& force = Vec3::Zero()) {
    HapticSample sample;
    for (const Nanos end = now + time; now < end; now += kMillisecond) {
      if (now % kFrame == 0) point(at);
      sample = device.read(now);
      device.write({force, Vec3::Zero()});
    }
    return sample;
  }
  HapticSample alone(Nanos time) {
    HapticSample sample;
    for (const Nanos end = now + time; now < end; now += kMillisecond) sample = device.read(now);
    return sample;
  }

  PageDevice device{page_hand()};
  Nanos now = 1000 * kSecond;
  std::uint64_t sent = 0;
};

TEST_F(PageDeviceTest, GoesToTheCursorAndStaysThere) {
  const Vec3 there(0.03, -0.02, 0.01);
  const HapticSample sample = hold(there, kSecond);
  EXPECT_LT((sample.X_MH.p - there).norm(), 1e-4);
  EXPECT_LT(sample.v_MH.norm(), 1e-3);
  EXPECT_EQ(sample.buttons, kHeld);
}

TEST_F(PageDeviceTest, FollowsACursorThatJumpsWithinATenthOfASecondAndWithoutAJump) {
  hold(Vec3::Zero(), 200 * kMillisecond);
  const Vec3 there(0.04, 0.0, 0.0);
  double last = 0.0, fastest = 0.0;
  HapticSample sample;
  for (int i = 0; i < 100; ++i) {
    sample = hold(there, kMillisecond);
    fastest = std::max(fastest, std::abs(sample.X_MH.p.x() - last));
    last = sample.X_MH.p.x();
  }
  EXPECT_GT(last, 0.9 * there.x());
  EXPECT_LT(fastest, 1.2e-3) << "in a millisecond [m]";
}

TEST_F(PageDeviceTest, YieldsToTheForceAsTheHandsSpringSays) {
  hold(Vec3::Zero(), kSecond);
  const double force = 7.0;
  const HapticSample pushed = hold(Vec3::Zero(), 3 * kSecond, Vec3(-force, 0.0, 0.0));
  const double yields = (force - kPageFriction) / page_hand().stiffness;
  EXPECT_NEAR(pushed.X_MH.p.x(), -yields, 0.1 * yields);
  const HapticSample back = hold(Vec3::Zero(), 3 * kSecond);
  EXPECT_NEAR(back.X_MH.p.x(), 0.0, 1.5e-3) << "friction holds the rest";
}

TEST_F(PageDeviceTest, LetsTheDeadManGoWithoutACursorForTwoTenthsOfASecond) {
  hold(Vec3(0.02, 0.0, 0.0), 320 * kMillisecond);
  EXPECT_EQ(alone(150 * kMillisecond).buttons, kHeld);
  const HapticSample gone = alone(100 * kMillisecond);
  EXPECT_EQ(gone.buttons, 0u);
  EXPECT_TRUE(gone.valid);
  const HapticSample later = alone(kSecond);
  EXPECT_LT((later.X_MH.p - gone.X_MH.p).norm(), 1e-4) << "the hand stays where it is";
  EXPECT_EQ(hold(later.X_MH.p, 20 * kMillisecond).buttons, kHeld) << "and takes over again";
}

TEST_F(PageDeviceTest, PushesAgainstNothingOnceTheCursorIsGone) {
  hold(Vec3(0.05, 0.0, 0.0), kSecond, Vec3(-15.0, 0.0, 0.0));
  const Vec3 held_off = device.read(now).X_MH.p;
  ASSERT_LT(held_off.x(), 0.02) << "the force keeps it from the cursor";
  while (device.read(now += kMillisecond).buttons != 0) {
    device.write({Vec3(-15.0, 0.0, 0.0), Vec3::Zero()});
  }
  const HapticSample later = alone(2 * kSecond);
  EXPECT_LT(later.X_MH.p.x(), held_off.x() + 1e-3) << "it does not spring to the cursor";
}

TEST_F(PageDeviceTest, TurnsAsTheCursorDoes) {
  const Quat turn = rotation_exp(Vec3(0.0, 0.0, 30.0 * kDeg));
  for (int i = 0; i < 60; ++i) {
    point(Vec3::Zero(), kHeld, turn);
    alone(kFrame);
  }
  EXPECT_LT(angle_between(device.read(now).X_MH.q, turn), 0.1 * kDeg);
}

TEST_F(PageDeviceTest, TakesACursorBeyondTheWorkSpaceForTheNearestPlaceInIt) {
  const HapticSample sample = hold(Vec3(0.5, -0.5, 0.0), 2 * kSecond);
  EXPECT_NEAR(sample.X_MH.p.x(), kPageHalf, 1e-4);
  EXPECT_NEAR(sample.X_MH.p.y(), -kPageHalf, 1e-4);
}

TEST_F(PageDeviceTest, IgnoresACursorThatIsNoPlace) {
  hold(Vec3(0.01, 0.0, 0.0), kSecond);
  point(Vec3(std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0));
  point(Vec3::Zero(), kHeld, Quat(0.0, 0.0, 0.0, 0.0));
  const HapticSample sample = alone(100 * kMillisecond);
  EXPECT_NEAR(sample.X_MH.p.x(), 0.01, 1e-4);
}

TEST_F(PageDeviceTest, GoesHomeWhenASceneAsksForIt) {
  hold(Vec3(0.04, 0.0, 0.0), kSecond);
  device.simulate(DeviceEffects(), Vec3(-0.02, 0.01, 0.0));
  const HapticSample home = alone(2 * kSecond);
  EXPECT_LT((home.X_MH.p - Vec3(-0.02, 0.01, 0.0)).norm(), 1e-3);
}

TEST_F(PageDeviceTest, LeadingDoesNotAllocate) {
  hold(Vec3::Zero(), kFrame);
  test::NoAllocation guard("page device");
  for (int i = 0; i < 200; ++i) {
    point(Vec3(1e-4 * i, 0.0, 0.0));
    device.read(now += kMillisecond);
    device.write({Vec3(1.0, 0.0, 0.0), Vec3::Zero()});
  }
}

}  // namespace
}  // namespace handrail
