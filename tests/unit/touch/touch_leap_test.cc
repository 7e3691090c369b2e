// A Touch whose place leaps as no hand does.
#include <gmock/gmock.h>

#include <memory>
#include <string>

#include "devices/touch/touch_device.h"
#include "tests/unit/touch/touch_bench.h"

namespace handrail {
namespace {

using test::HdState;
using ::testing::HasSubstr;

class TouchLeapTest : public test::TouchBench {
 protected:
  void open() {
    device = std::make_unique<TouchDevice>(options);
    const Status opened = device->open();
    ASSERT_TRUE(opened) << opened.message();
    ASSERT_TRUE(valid());
  }
  void TearDown() override {
    device.reset();
    TouchBench::TearDown();
  }
  HapticSample read() { return device->read(monotonic_now()); }
  bool valid(bool wanted = true) {
    return becomes([&] { return read().valid == wanted; });
  }
  std::string trouble() { return std::string(text_of(device->trouble())); }
  void off(int axis, double mm) {
    hd([&](HdState& s) { s.off[static_cast<std::size_t>(axis)] = mm; });
  }
  // Whether a leap is seen; if it is not, it is back. A turn that this computer had late by so much
  // takes it for a hand's way, as it must: then it is tried again.
  bool leaps(int axis, double mm) {
    for (int i = 0; i < 20; ++i) {
      leapt = monotonic_now();
      off(axis, mm);
      for (int k = 0; k < 20; ++k) {
        if (!read().valid) return true;
        sleep_until(monotonic_now() + kMillisecond);
      }
      // Its place is taken with its lock held, for as long as a hand needs for the way back.
      hd([&](HdState& s) {
        sleep_until(monotonic_now() + 20 * kMillisecond);
        s.off[static_cast<std::size_t>(axis)] = 0.0;
      });
    }
    return false;
  }

  std::unique_ptr<TouchDevice> device;
  Nanos leapt = 0;  // just before the last leap
};

TEST_F(TouchLeapTest, ItIsLostSaysWhyAndIsOpenedAgainWhereItIs) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double mm : {60.0, -60.0}) {
      off(axis, 0.0);
      ASSERT_NO_FATAL_FAILURE(open());
      hd([](HdState& s) { s.opened = 0; });
      ASSERT_TRUE(leaps(axis, mm));
      const std::string way = std::string("XYZ").substr(static_cast<std::size_t>(axis), 1) +
                              " leapt by " + (mm > 0 ? "" : "-") + "60.0 mm, in ";
      EXPECT_THAT(trouble(), HasSubstr("its " + way));
      EXPECT_THAT(trouble(), HasSubstr(" m/s, and at most 10 are a hand's; look at its cable"));
      ASSERT_TRUE(valid());
      EXPECT_GE(monotonic_now() - leapt, 500 * kMillisecond) << "as any failure that lasts";
      EXPECT_EQ(device->tick().losses, 1u);
      EXPECT_GE(hd([](HdState& s) { return s.opened; }), 1);
      EXPECT_NEAR(read().X_MH.p[axis], 1e-3 * mm, 1e-3);
      EXPECT_EQ(text_of(device->tick().lost_for), "");
    }
  }
}

TEST_F(TouchLeapTest, WhatIsHomedAnewIsSaidWithIt) {
  hd([](HdState& s) { s.styles = 4; });
  ASSERT_NO_FATAL_FAILURE(open());
  hd([](HdState& s) { s.calibration = 0x5002; });
  ASSERT_TRUE(leaps(0, 60.0));
  ASSERT_TRUE(becomes([&] {
    (void)read();
    return device->tick().losses == 1;
  }));
  EXPECT_THAT(trouble(), HasSubstr("look at its cable; it is not homed: put the stylus into "
                                   "the inkwell"));
  hd([](HdState& s) { s.calibration = 0x5000; });
  ASSERT_TRUE(valid());
  hd([](HdState& s) { s.turns = false; });
  ASSERT_TRUE(valid(false));
  EXPECT_EQ(trouble(), "its library gives no readings; look at cable and power");
}

TEST_F(TouchLeapTest, TheForceEndsAndComesBackSlowly) {
  ASSERT_NO_FATAL_FAILURE(open());
  const auto force = [this] {
    device->write({Vec3(1.0, 0.0, 0.0), Vec3::Zero()});
    return hd([](HdState& s) { return s.force[0]; });
  };
  ASSERT_TRUE(becomes([&] { return force() == 1.0; }));
  const std::uint64_t offs = device->tick().force_offs;
  ASSERT_TRUE(leaps(1, 60.0));
  EXPECT_EQ(device->tick().force_offs, offs + 1);
  ASSERT_TRUE(becomes([&] { return force() == 0.0; }));
  EXPECT_FALSE(read().valid);
  ASSERT_TRUE(valid());
  EXPECT_LT(force(), 0.1);
  ASSERT_TRUE(becomes([&] { return force() == 1.0; }));
}

TEST_F(TouchLeapTest, AThreadThatWasLateTakesNoWayForALeap) {
  ASSERT_NO_FATAL_FAILURE(open());
  // The library answers late: its lock is held for so long as a hand takes for the way.
  hd([](HdState& s) {
    sleep_until(monotonic_now() + 10 * kMillisecond);
    s.off[0] = 60.0;
  });
  ASSERT_TRUE(becomes([&] { return read().X_MH.p.x() > 0.05; }));
  EXPECT_EQ(device->tick().losses, 0u);
  EXPECT_EQ(text_of(device->tick().lost_for), "");
}

TEST_F(TouchLeapTest, WhileItSaysThatItsCableFailsNothingIsALeap) {
  ASSERT_NO_FATAL_FAILURE(open());
  hd([](HdState& s) { s.tick_error = kHdCommError; });
  ASSERT_TRUE(valid(false));
  off(2, 60.0);
  sleep_until(monotonic_now() + 20 * kMillisecond);
  off(2, 0.0);
  hd([](HdState& s) { s.tick_error = 0; });
  ASSERT_TRUE(valid());
  EXPECT_EQ(device->tick().losses, 0u);
}

}  // namespace
}  // namespace handrail
