// Debian's spacenavd, which believes that a Magellan is at a serial port: a pseudo-terminal of
// ours.
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>

#include "devices/spacemouse/spacemouse_device.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "tests/loopback/program.h"
#include "tests/support/real_spacenavd.h"

namespace handrail {
namespace {

class RealSpacenavd : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!test::RealSpacenavd::installed()) GTEST_SKIP() << test::RealSpacenavd::kMissing;
    ASSERT_TRUE(daemon.start(Program::kPatience)) << daemon.log();
    options.socket = daemon.socket();
    device = std::make_unique<SpaceMouseDevice>(options);
    ASSERT_TRUE(device->open()) << daemon.log();
  }
  // Until `is` holds of a reading, at most for the patience; pushes anew every 20 ms if asked to.
  template <typename Is>
  bool becomes(Is is, const std::array<int, 6>* push = nullptr) {
    const Nanos give_up = monotonic_now() + Program::kPatience;
    Nanos next = 0;
    while (monotonic_now() < give_up) {
      if (push != nullptr && monotonic_now() >= next) {
        EXPECT_TRUE(daemon.magellan.push(*push));
        next = monotonic_now() + 20 * kMillisecond;
      }
      last = device->read(monotonic_now());
      if (is(last)) return true;
      sleep_until(monotonic_now() + kMillisecond);
    }
    return false;
  }

  test::RealSpacenavd daemon;
  SpaceMouseOptions options;
  std::unique_ptr<SpaceMouseDevice> device;
  HapticSample last;
};

TEST_F(RealSpacenavd, ThePushOfEachAxisMovesThatOfMAndEnds) {
  for (int axis = 0; axis < 3; ++axis) {
    std::array<int, 6> counts{};
    counts[static_cast<std::size_t>(axis)] = 350;
    const auto goes = [axis](const HapticSample& s) {
      return s.valid && s.v_MH[axis] > 0.04 && s.v_MH[axis] <= 0.05 + 1e-9;
    };
    EXPECT_TRUE(becomes(goes, &counts)) << axis << ": " << last.v_MH.transpose();
    const Vec3 others = last.v_MH - last.v_MH[axis] * Vec3::Unit(axis);
    EXPECT_LT(others.norm(), 1e-3) << axis;
    // It is held and never let go of: the daemon says nothing more.
    EXPECT_TRUE(becomes([](const HapticSample& s) { return s.v_MH.norm() < 1e-4; })) << axis;
  }
}

TEST_F(RealSpacenavd, ButtonsGoDownAndUpAndItsEndIsNoReading) {
  EXPECT_TRUE(becomes([](const HapticSample& s) { return s.valid && s.buttons == 0; }));
  EXPECT_TRUE(daemon.magellan.press(1));
  EXPECT_TRUE(becomes([](const HapticSample& s) { return s.buttons == 1; })) << last.buttons;
  EXPECT_TRUE(daemon.magellan.press(2));
  EXPECT_TRUE(becomes([](const HapticSample& s) { return s.buttons == 2; })) << last.buttons;
  EXPECT_TRUE(daemon.magellan.press(0));
  EXPECT_TRUE(becomes([](const HapticSample& s) { return s.buttons == 0; })) << last.buttons;
  daemon.kill();
  EXPECT_TRUE(becomes([](const HapticSample& s) { return !s.valid; }));
}

}  // namespace
}  // namespace handrail
