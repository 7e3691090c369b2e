// The Touch, over a stand-in for the vendor's library.
#include "devices/touch/touch_device.h"

#include <gmock/gmock.h>

#include <numbers>

#include "devices/haptic_device.h"
#include "tests/support/no_allocation.h"
#include "tests/unit/touch/touch_bench.h"

namespace handrail {
namespace {

using test::HdState;
using ::testing::HasSubstr;

class TouchDeviceTest : public test::TouchBench {
 protected:
  void open() {
    device = std::make_unique<TouchDevice>(options);
    const Status opened = device->open();
    ASSERT_TRUE(opened) << opened.message();
  }
  std::string open_error() {
    TouchDevice fails(options);
    return fails.open().message();
  }
  HapticSample read() { return device->read(monotonic_now()); }
  bool valid(bool wanted = true) {
    return becomes([&] { return read().valid == wanted; });
  }
  double force() {
    return hd([](HdState& s) { return s.force[0]; });
  }
  // Keeps writing until the device pushes so.
  bool pushes(double wanted, double written) {
    return becomes([&] {
      device->write({Vec3(written, 0.0, 0.0), Vec3::Zero()});
      return std::abs(force() - wanted) < 1e-9;
    });
  }
  // A newton comes back in the second that begins now, and in no leap.
  void expect_slow_return() {
    const Nanos ended = monotonic_now();
    double most_rise = 0.0, before = 0.0;
    EXPECT_TRUE(becomes([&] {
      device->write({Vec3(1.0, 0.0, 0.0), Vec3::Zero()});
      const double now = force();
      most_rise = std::max(most_rise, now - before);
      before = now;
      return now == 1.0;
    }));
    EXPECT_GE(monotonic_now() - ended, 900 * kMillisecond);
    EXPECT_LT(most_rise, 0.5);  // however late this computer looked
  }
  void TearDown() override {
    device.reset();
    TouchBench::TearDown();
  }

  std::unique_ptr<TouchDevice> device;
};

TEST_F(TouchDeviceTest, OpensTheDefaultByEachOfItsNamesAndAsksForThousandTurns) {
  ASSERT_NO_FATAL_FAILURE(open());
  EXPECT_TRUE(valid());
  EXPECT_EQ(hd([](HdState& s) { return s.opened; }), 2);  // "Default Device" is not its name
  EXPECT_EQ(hd([](HdState& s) { return s.rate; }), 1000u);
  EXPECT_EQ(hd([](HdState& s) { return s.priority; }), 65535);
  EXPECT_EQ(device->model(), "PHANTOM Omni");
  EXPECT_EQ(device->serial(), "1234");
  EXPECT_EQ(device->driver_version(), "4.2.122");
  EXPECT_FALSE(device->capabilities().simulated);
  EXPECT_EQ(device->capabilities().max_force, 3.3);
  EXPECT_NEAR(device->capabilities().dynamics.delay, 0.35e-3, 1e-12);
  hd([](HdState& s) { s.name = "somebody's"; });
  device->close();
  EXPECT_TRUE(device->open());  // by no name at all
  options.name = "somebody's";
  device.reset();
  EXPECT_NO_FATAL_FAILURE(open());
}

TEST_F(TouchDeviceTest, WhatTheVendorSaysIsPassedOnWithWhatToDo) {
  options.name = "mine";
  EXPECT_THAT(open_error(), HasSubstr("cannot open 'mine': Some error (0x303, internal 772); set "
                                      "it up with the vendor's Touch_Setup"));
  options.name = "";
  hd([](HdState& s) { s.init_error = kHdCommError; });
  EXPECT_THAT(open_error(), HasSubstr("cannot open the default device: Communication error"));
  EXPECT_THAT(open_error(), HasSubstr("look at cable and power"));
  hd([](HdState& s) {
    s.init_error = 0;
    s.start_error = kHdInvalidLicense;
  });
  EXPECT_THAT(open_error(), HasSubstr("does not start: Invalid license (0x600"));
  EXPECT_THAT(open_error(), HasSubstr("install the licence"));
  hd([](HdState& s) {
    s.start_error = 0;
    s.turns = false;
  });
  EXPECT_THAT(open_error(), HasSubstr("no tick in a second"));
}

TEST_F(TouchDeviceTest, ALibraryThatIsNoneIsNamed) {
  options.library = "/nowhere/libHD.so";
  EXPECT_THAT(open_error(), HasSubstr("/nowhere/libHD.so: cannot be loaded"));
  EXPECT_THAT(open_error(), HasSubstr("install TouchDriver and OpenHaptics"));
  options.library = "libm.so.6";
  EXPECT_THAT(open_error(), HasSubstr("libm.so.6: has no hdInitDevice, expected libHD"));
}

TEST_F(TouchDeviceTest, PlaceTurnSpeedAndButtonsAreThoseOfTheStylus) {
  ASSERT_NO_FATAL_FAILURE(open());
  const double half = std::numbers::sqrt2 / 2.0;
  hd([&](HdState& s) {
    s.place = s.target = {10.0, 20.0, -30.0};
    s.speed = {};
    s.turn = {half, 0.0, half, 0.0};  // a quarter about up
    s.buttons = 2;
  });
  ASSERT_TRUE(becomes([&] { return read().buttons == 2u; }));
  EXPECT_TRUE(read().X_MH.p.isApprox(Vec3(0.01, 0.02, -0.03), 1e-9));
  EXPECT_TRUE((read().X_MH.q * Vec3::UnitX()).isApprox(-Vec3::UnitZ(), 1e-9));
  // Half a second's way to the right.
  hd([](HdState& s) { s.target[0] = 60.0; });
  EXPECT_TRUE(becomes([&] { return read().v_MH.x() > 0.05; }));
}

TEST_F(TouchDeviceTest, WithoutCalibrationNothingIsValidAndNothingPushes) {
  hd([](HdState& s) { s.calibration = kHdNeedsManual; });
  ASSERT_NO_FATAL_FAILURE(open());
  EXPECT_FALSE(read().valid);
  EXPECT_EQ(device->tick().homing, TouchHoming::kInkwell);
  for (int i = 0; i < 200; ++i) {
    device->write({Vec3(1.0, 0.0, 0.0), Vec3::Zero()});
    sleep_until(monotonic_now() + kMillisecond);
  }
  EXPECT_EQ(hd([](HdState& s) { return s.most_force; }), 0.0);
  EXPECT_EQ(hd([](HdState& s) { return s.enabled; }), 0);
  // Now the stylus is in the inkwell.
  hd([](HdState& s) { s.calibration = kHdNeedsUpdate; });
  EXPECT_TRUE(valid());
  EXPECT_EQ(hd([](HdState& s) { return s.updates; }), 1);
  EXPECT_EQ(hd([](HdState& s) { return s.style; }), kHdInkwell);
}

TEST_F(TouchDeviceTest, TheWayToHomeIsTheOneWithTheLeastWork) {
  const std::pair<int, TouchHoming> cases[] = {
      {kHdEncoderReset, TouchHoming::kByHand},
      {kHdEncoderReset | kHdInkwell, TouchHoming::kInkwell},
      {kHdAuto | kHdInkwell, TouchHoming::kByItself}};
  for (const auto& [styles, homing] : cases) {
    hd([&, known = styles](HdState& s) {
      s.styles = known;
      s.calibration = kHdNeedsManual;
    });
    ASSERT_NO_FATAL_FAILURE(open());
    (void)read();
    EXPECT_EQ(device->tick().homing, homing) << styles;
  }
}

TEST_F(TouchDeviceTest, AForceActsUntilItIsNotRenewed) {
  ASSERT_NO_FATAL_FAILURE(open());
  EXPECT_TRUE(pushes(1.5, 1.5));
  EXPECT_TRUE(hd([](HdState& s) { return s.output; }));
  EXPECT_TRUE(becomes([&] { return force() == 0.0; }));
  EXPECT_TRUE(pushes(-0.5, -0.5));
  // Not a number is none.
  EXPECT_TRUE(becomes([&] {
    device->write({Vec3(std::nan(""), 1.0, 1.0), Vec3::Zero()});
    return force() == 0.0;
  }));
}

TEST_F(TouchDeviceTest, NoForceIsAboveTheModelsNominalOneNorAboveATouchs) {
  hd([](HdState& s) { s.nominal_force = 0.9; });
  ASSERT_NO_FATAL_FAILURE(open());
  EXPECT_TRUE(pushes(0.9, 30.0));
  device->close();
  hd([](HdState& s) { s.nominal_force = 22.0; });
  ASSERT_TRUE(device->open());
  EXPECT_TRUE(pushes(3.3, 30.0));
  EXPECT_LE(hd([](HdState& s) { return s.most_force; }), 3.3 + 1e-9);
}

TEST_F(TouchDeviceTest, AfterAnErrorOfForceItIsSwitchedOnAgainAndComesBackSlowly) {
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(pushes(1.0, 1.0));
  hd([](HdState& s) { s.tick_error = kHdExceededVelocity; });
  EXPECT_TRUE(becomes([&] {
    device->write({Vec3(1.0, 0.0, 0.0), Vec3::Zero()});
    return force() == 0.0;
  }));
  EXPECT_TRUE(read().valid);  // its place is as good as ever
  EXPECT_EQ(device->tick().error.code, kHdExceededVelocity);
  hd([](HdState& s) {
    s.tick_error = 0;
    s.enabled = 0;
  });
  expect_slow_return();
  EXPECT_EQ(hd([](HdState& s) { return s.enabled; }), 1);
  (void)read();
  EXPECT_GE(device->tick().force_offs, 1u);
}

TEST_F(TouchDeviceTest, WithoutItsCableNothingIsValidUntilItIsBack) {
  ASSERT_NO_FATAL_FAILURE(open());
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(valid());
    hd([](HdState& s) { s.tick_error = kHdCommError; });
    EXPECT_TRUE(valid(false));
    EXPECT_FALSE(hd([](HdState& s) { return s.output; }));
    hd([](HdState& s) { s.tick_error = 0; });
  }
  EXPECT_TRUE(valid());
}

TEST_F(TouchDeviceTest, AHotMotorRestsUntilItHasCooled) {
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(pushes(1.0, 1.0));
  hd([](HdState& s) { s.temperature = 1.0; });
  EXPECT_TRUE(pushes(0.0, 1.0));
  hd([](HdState& s) { s.temperature = 0.95; });
  (void)becomes([&, until = monotonic_now() + 300 * kMillisecond] {
    device->write({Vec3(1.0, 0.0, 0.0), Vec3::Zero()});
    return monotonic_now() > until;
  });
  EXPECT_EQ(force(), 0.0);
  hd([](HdState& s) { s.temperature = 0.5; });
  EXPECT_TRUE(pushes(1.0, 1.0));
  EXPECT_TRUE(read().valid);
}

TEST_F(TouchDeviceTest, WhatIsNoPoseIsNotValid) {
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(valid());
  hd([](HdState& s) { s.not_a_pose = true; });
  EXPECT_TRUE(valid(false));
  EXPECT_TRUE(is_finite(read().X_MH));
}

TEST_F(TouchDeviceTest, AThreadThatStandsStillIsNoticed) {
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(valid());
  hd([](HdState& s) { s.turns = false; });
  EXPECT_TRUE(valid(false));
  hd([](HdState& s) { s.turns = true; });
  EXPECT_TRUE(valid());
}

// A tenth of the pause that is usual would be over long before.
TEST_F(TouchDeviceTest, ItIsOpenedAgainAfterAPause) {
  options.lost_after = 40 * kMillisecond;
  options.reopen_pause = 400 * kMillisecond;
  ASSERT_NO_FATAL_FAILURE(open());
  hd([](HdState& s) { s.init_error = kHdCommError, s.tick_error = kHdCommError, s.opened = 0; });
  const auto tries = [this] { return hd([](HdState& s) { return s.opened; }); };
  ASSERT_TRUE(becomes([&] { return tries() > 0; }));
  const int first = tries();
  const Nanos began = monotonic_now();
  ASSERT_TRUE(becomes([&] { return tries() > first + 3; }));
  EXPECT_GE(monotonic_now() - began, 350 * kMillisecond);
  hd([](HdState& s) { s.init_error = s.tick_error = 0; });
  EXPECT_TRUE(valid());
}

TEST_F(TouchDeviceTest, ItSaysWhyThereIsNoReading) {
  const auto trouble = [this] { return std::string(text_of(device->trouble())); };
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(valid());
  hd([](HdState& s) { s.tick_error = kHdCommError; });
  ASSERT_TRUE(valid(false));
  EXPECT_THAT(trouble(), HasSubstr("of its library; look at cable and power"));
  hd([](HdState& s) { s.tick_error = 0, s.turns = true; });
  ASSERT_TRUE(valid());
  hd([](HdState& s) { s.turns = false; });
  ASSERT_TRUE(valid(false));
  EXPECT_EQ(trouble(), "its library gives no readings; look at cable and power");
  hd([](HdState& s) { s.turns = true, s.not_a_pose = true; });
  ASSERT_TRUE(
      becomes([&] { return (void)read(), trouble().starts_with("its library gives no pose"); }));
  hd([](HdState& s) {
    s.not_a_pose = false;
    s.styles = kHdInkwell;
    s.calibration = kHdNeedsManual;
  });
  ASSERT_NO_FATAL_FAILURE(open());
  EXPECT_FALSE(read().valid);
  EXPECT_EQ(trouble(), "it is not homed: put the stylus into the inkwell");
  device->close();
  EXPECT_EQ(trouble(), "it is not open");
}

// The cable, or the vendor's scheduler; homing is asked anew each time.
TEST_F(TouchDeviceTest, LostAHundredTimesItIsOpenedAgainByItself) {
  options.lost_after = 40 * kMillisecond;
  options.reopen_pause = kMillisecond;
  ASSERT_NO_FATAL_FAILURE(open());
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(valid()) << i;
    hd([&](HdState& s) {
      s.init_error = kHdCommError;
      i % 2 == 0 ? s.tick_error = kHdCommError : s.turns = false;
      s.calibration = kHdNeedsUpdate;
      s.updates = 0;
    });
    ASSERT_TRUE(valid(false)) << i;
    ASSERT_TRUE(becomes([&] { return hd([](HdState& s) { return s.open_devices; }) == 0; })) << i;
    EXPECT_FALSE(hd([](HdState& s) { return s.output; }));
    hd([](HdState& s) { s.init_error = s.tick_error = 0, s.turns = true; });
    ASSERT_TRUE(valid()) << i;
    EXPECT_EQ(hd([](HdState& s) { return s.updates; }), 1) << i;
  }
  EXPECT_EQ(device->tick().losses, 100u);
}

TEST_F(TouchDeviceTest, AfterALossTheForceComesBackSlowly) {
  options.lost_after = 40 * kMillisecond;
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(pushes(1.0, 1.0));
  hd([](HdState& s) { s.turns = false; });
  ASSERT_TRUE(becomes([&] { return hd([](HdState& s) { return s.open_devices; }) == 0; }));
  hd([](HdState& s) { s.turns = true; });
  ASSERT_TRUE(valid());
  expect_slow_return();
}

TEST_F(TouchDeviceTest, AShortDipIsNoLoss) {
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(valid());
  hd([](HdState& s) { s.turns = false, s.opened = 0; });
  sleep_until(monotonic_now() + 200 * kMillisecond);
  EXPECT_FALSE(read().valid);
  hd([](HdState& s) { s.turns = true; });
  ASSERT_TRUE(valid());
  EXPECT_EQ(device->tick().losses, 0u);
  EXPECT_EQ(hd([](HdState& s) { return s.opened; }), 0);
}

TEST_F(TouchDeviceTest, ClosedItIsLetGoOfAndMayBeOpenedAgain) {
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(pushes(1.0, 1.0));
  device->close();
  device->close();
  EXPECT_FALSE(read().valid);
  EXPECT_FALSE(hd([](HdState& s) { return s.output; }));
  EXPECT_EQ(hd([](HdState& s) { return s.open_devices; }), 0);
  device->write({Vec3(1.0, 0.0, 0.0), Vec3::Zero()});
  ASSERT_TRUE(device->open());
  EXPECT_TRUE(valid());
  // What was written while it was closed pushes nobody.
  sleep_until(monotonic_now() + 20 * kMillisecond);
  EXPECT_EQ(force(), 0.0);
}

TEST_F(TouchDeviceTest, ReadingAndWritingDoNotAllocate) {
  ASSERT_NO_FATAL_FAILURE(open());
  test::NoAllocation guard("touch");
  for (int i = 0; i < 100; ++i) {
    (void)device->wait(monotonic_now() + kMillisecond);
    (void)read();
    device->write({Vec3(0.1, 0.0, 0.0), Vec3::Zero()});
    sleep_until(monotonic_now() + kMillisecond);
  }
}

}  // namespace
}  // namespace handrail
