#include "devices/evdev/gamepad_device.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "tests/support/fake_gamepad.h"
#include "tests/support/no_allocation.h"
#include "tests/support/read_bench.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

using test::FakeGamepad;
using ::testing::HasSubstr;

class GamepadDeviceTest : public test::ReadBench {
 protected:
  GamepadDeviceTest() {
    kernel.make_pad();
    options.path = "/dev/input/event5";
  }
  void open() {
    device = std::make_unique<GamepadDevice>(options, kernel);
    const Status opened = device->open();
    ASSERT_TRUE(opened) << opened.message();
    ASSERT_TRUE(becomes(true));
  }
  HapticDevice& read_device() override { return *device; }

  FakeGamepad kernel;
  GamepadOptions options;
  std::unique_ptr<GamepadDevice> device;
};

constexpr int kFull = 32767;

TEST_F(GamepadDeviceTest, EachStickMovesItsAxisAtTheSpeedOfTheConfiguration) {
  struct Push {
    unsigned axis;
    int value;
    Vec3 way;
  };
  const Push pushes[] = {{ABS_X, kFull, Vec3::UnitX()},   {ABS_X, -kFull, -Vec3::UnitX()},
                         {ABS_Y, kFull, Vec3::UnitZ()},   {ABS_Y, -kFull, -Vec3::UnitZ()},
                         {ABS_RY, -kFull, Vec3::UnitY()}, {ABS_RY, kFull, -Vec3::UnitY()}};
  ASSERT_NO_FATAL_FAILURE(open());
  for (const Push& push : pushes) {
    kernel.axis(push.axis, push.value);
    EXPECT_TRUE(after(0.3).v_MH.isApprox(0.05 * push.way, 1e-3)) << push.axis << " " << push.value;
    kernel.axis(push.axis, 0);
    EXPECT_LT(after(0.3).v_MH.norm(), 1e-5);
  }
  // The right stick to the right turns clockwise, as seen from above.
  kernel.axis(ABS_RX, kFull);
  const Vec3 turned = rotation_log(after(1.0).X_MH.q);
  EXPECT_LT(turned.y(), -0.4);
  EXPECT_LT(Vec3(turned.x(), 0.0, turned.z()).norm(), 1e-9);
}

TEST_F(GamepadDeviceTest, InPositionModeTheHandIsWhereTheStickIs) {
  options.motion.mode = DeflectionMode::kPosition;
  options.motion.reach = 0.08;
  ASSERT_NO_FATAL_FAILURE(open());
  kernel.axis(ABS_X, kFull);
  EXPECT_NEAR(after(0.5).X_MH.p.x(), 0.08, 1e-4);
  kernel.axis(ABS_X, 0);
  EXPECT_NEAR(after(0.5).X_MH.p.x(), 0.0, 1e-4);
}

TEST_F(GamepadDeviceTest, AroundTheMiddleNothingMovesAndBeyondItGrowsFromNothing) {
  ASSERT_NO_FATAL_FAILURE(open());
  kernel.axis(ABS_X, static_cast<int>(0.119 * kFull));
  EXPECT_EQ(after(0.3).v_MH.norm(), 0.0);
  kernel.axis(ABS_X, static_cast<int>(0.14 * kFull));
  const double slow = after(0.3).v_MH.x();
  EXPECT_GT(slow, 0.0);
  EXPECT_LT(slow, 0.002);
  // The device's own `flat` counts where it is more.
  const FakeGamepad::Axis wide{-100, 100, 0, 40};
  kernel.make({BTN_SOUTH}, {{ABS_X, wide}, {ABS_Y, wide}});
  ASSERT_NO_FATAL_FAILURE(open());
  kernel.axis(ABS_X, 39);
  EXPECT_EQ(after(0.3).v_MH.norm(), 0.0);
  kernel.axis(ABS_X, 60);
  EXPECT_GT(after(0.3).v_MH.x(), 0.001);
}

TEST_F(GamepadDeviceTest, AnAxisThatReadsAsPushedBeforeItWasMovedCountsOnceItWasInTheMiddle) {
  const FakeGamepad::Axis byte{0, 255, 128, 0}, stuck{0, 255, 0, 0};
  kernel.make({BTN_SOUTH}, {{ABS_X, byte}, {ABS_Y, stuck}});
  ASSERT_NO_FATAL_FAILURE(open());
  EXPECT_EQ(after(0.3).v_MH.norm(), 0.0);
  kernel.axis(ABS_Y, 127);
  EXPECT_EQ(after(0.1).v_MH.norm(), 0.0);
  kernel.axis(ABS_Y, 0);
  EXPECT_NEAR(after(0.3).v_MH.z(), -0.05, 1e-4);
}

TEST_F(GamepadDeviceTest, ButtonsOfAPadAndOfAJoystick) {
  ASSERT_NO_FATAL_FAILURE(open());
  EXPECT_EQ(device->capabilities().buttons, 3);
  EXPECT_EQ(device->capabilities().max_force, 0.0);
  kernel.key(BTN_TL, 1);
  EXPECT_EQ(read().buttons, 1u);
  kernel.key(BTN_SOUTH, 1);
  EXPECT_EQ(read().buttons, 3u);
  kernel.key(BTN_TR, 1);
  EXPECT_EQ(read().buttons, 7u);
  kernel.key(BTN_TL, 0);
  EXPECT_EQ(read().buttons, 6u);
  const FakeGamepad::Axis stick{-100, 100, 0, 0}, hat{-1, 1, 0, 0};
  kernel.make({BTN_TRIGGER, BTN_THUMB, BTN_THUMB2},
              {{ABS_X, stick}, {ABS_Y, stick}, {ABS_RZ, stick}, {ABS_HAT0Y, hat}});
  kernel.hold({BTN_TRIGGER});  // as it is opened
  ASSERT_NO_FATAL_FAILURE(open());
  EXPECT_EQ(read().buttons, 4u);
  kernel.key(BTN_THUMB, 1);
  EXPECT_EQ(read().buttons, 5u);
  kernel.key(BTN_THUMB, 0);
  kernel.axis(ABS_HAT0Y, -1);
  EXPECT_NEAR(after(0.3).v_MH.y(), 0.05, 1e-4);
}

TEST_F(GamepadDeviceTest, TheClutchBringsTheHandToTheMiddle) {
  ASSERT_NO_FATAL_FAILURE(open());
  kernel.axis(ABS_X, kFull);
  EXPECT_GT(after(1.0).X_MH.p.x(), 0.04);
  kernel.key(BTN_TL, 1);
  EXPECT_LT(after(1.5).X_MH.p.norm(), 1e-3);
}

TEST_F(GamepadDeviceTest, WhatIsNoGamepadIsRefusedAndWhatCannotBeOpenedToo) {
  kernel.make({KEY_A}, {});
  EXPECT_THAT(GamepadDevice(options, kernel).open().message(),
              HasSubstr("Made-up pad has no stick with two axes and buttons"));
  kernel.refuse(EACCES);
  EXPECT_THAT(GamepadDevice(options, kernel).open().message(), HasSubstr("usermod -aG input"));
}

TEST_F(GamepadDeviceTest, WithoutAPathTheFirstOfTheFolderIsTaken) {
  const TempFolder folder;
  options.path.clear();
  options.input_folder = folder.path();
  EXPECT_THAT(GamepadDevice(options, kernel).open().message(),
              HasSubstr("none among 0 input devices of " + folder.path() + "; plug one in"));
  folder.write("event3", "");
  folder.write("mouse0", "");
  EXPECT_EQ(gamepad_paths(folder.path()), std::vector{folder.path() + "/event3"});
  const std::string named = folder.write("by-id/usb-Pad-event-joystick", "");
  folder.write("by-id/usb-Pad-joystick", "");
  EXPECT_EQ(gamepad_paths(folder.path()), std::vector{named});
  EXPECT_NO_FATAL_FAILURE(open());
  kernel.refuse(EACCES);
  EXPECT_THAT(GamepadDevice(options, kernel).open().message(), HasSubstr("usermod -aG input"));
}

TEST_F(GamepadDeviceTest, PulledOutAndPluggedInAHundredTimes) {
  options.reopen_pause = kMillisecond;
  ASSERT_NO_FATAL_FAILURE(open());
  kernel.axis(ABS_X, kFull);
  const double x = after(0.5).X_MH.p.x();
  for (int i = 0; i < 100; ++i) {
    kernel.axis(ABS_X, kFull);
    kernel.key(BTN_TR, 1);
    ASSERT_EQ(read().buttons, 4u) << i;
    kernel.unplug();
    ASSERT_TRUE(becomes(false)) << i;
    EXPECT_EQ(read().buttons, 0u);
    kernel.refuse(0);
    ASSERT_TRUE(becomes(true)) << i;
    // At rest, about where it was: what was pushed as it was pulled out is
    // pushed no more.
    const HapticSample back = after(0.05);
    ASSERT_LT(back.v_MH.norm(), 1e-9) << i;
    ASSERT_NEAR(back.X_MH.p.x(), x, 0.02) << i;
  }
  EXPECT_GE(kernel.opened(), 101);
  kernel.axis(ABS_X, -kFull);
  EXPECT_NEAR(after(0.3).v_MH.x(), -0.05, 1e-4);
}

TEST_F(GamepadDeviceTest, PluggedInAnewAnAxisCountsOnlyOnceItWasInTheMiddleAgain) {
  ASSERT_NO_FATAL_FAILURE(open());
  kernel.unplug();
  ASSERT_TRUE(becomes(false));
  const FakeGamepad::Axis pushed{-32768, 32767, 32767, 0};
  kernel.make({BTN_SOUTH}, {{ABS_X, pushed}, {ABS_Y, pushed}});
  kernel.refuse(0);
  ASSERT_TRUE(becomes(true));
  EXPECT_EQ(after(0.3).v_MH.norm(), 0.0);
}

TEST_F(GamepadDeviceTest, WhereTheKernelHadNoRoomTheDeviceIsAskedAnew) {
  ASSERT_NO_FATAL_FAILURE(open());
  const int before = kernel.opened();
  kernel.drop();
  ASSERT_TRUE(becomes(false));
  ASSERT_TRUE(becomes(true));
  EXPECT_GT(kernel.opened(), before);
}

TEST_F(GamepadDeviceTest, ReadingDoesNotAllocate) {
  ASSERT_NO_FATAL_FAILURE(open());
  kernel.axis(ABS_X, kFull);
  test::NoAllocation guard("gamepad");
  for (int i = 0; i < 100; ++i) read();
}

}  // namespace
}  // namespace handrail
