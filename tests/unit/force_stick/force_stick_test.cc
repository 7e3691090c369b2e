// Where a force-feedback joystick or wheel is, and what it says it can.
#include "devices/force_stick/force_stick.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "server/base/clock.h"
#include "tests/support/fake_force_stick.h"
#include "tests/support/no_allocation.h"
#include "tests/support/read_bench.h"

namespace handrail {
namespace {

using test::FakeForceStick;
using ::testing::HasSubstr;

class ForceStickDeviceTest : public test::ReadBench {
 protected:
  ForceStickDeviceTest() { options.path = "/dev/input/event5"; }
  void open() {
    device = std::make_unique<ForceStick>(options, kernel);
    const Status opened = device->open();
    ASSERT_TRUE(opened) << opened.message();
  }
  HapticDevice& read_device() override { return *device; }
  // So long for its next way, in ms.
  static void hand_has(int time) { std::this_thread::sleep_for(std::chrono::milliseconds(time)); }
  // Whether a leap from the middle to `counts` is seen; if it is not, the axis is back there. A
  // computer that paused for so long takes it for a hand's way, as it must: then it is tried again.
  bool leaps(unsigned int code, int counts) {
    for (int i = 0; i < 20; ++i) {
      kernel.axis(code, counts);
      leapt = monotonic_now();
      if (!read().valid) return true;
      hand_has(50);
      kernel.axis(code, 512);
      (void)read();
    }
    return false;
  }
  std::string trouble() { return std::string(text_of(device->trouble())); }
  Nanos leapt = 0;  // before the reading of the last leap

  FakeForceStick kernel;
  ForceStickOptions options;
  std::unique_ptr<ForceStick> device;
};

TEST_F(ForceStickDeviceTest, TheHandIsWhereTheStickIs) {
  options.reach = 0.08;
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(becomes(true));
  // 512 of 0 to 1023 is half a count right of the middle.
  EXPECT_NEAR(read().X_MH.p.x(), 0.08 * 0.5 / 511.5, 1e-9);
  kernel.axis(ABS_X, 1023);
  EXPECT_NEAR(read().X_MH.p.x(), 0.08, 1e-12);
  kernel.axis(ABS_Y, 1023);
  EXPECT_NEAR(read().X_MH.p.y(), -0.08, 1e-12) << "the kernel's Y is toward the user";
  hand_has(50);
  kernel.axis(ABS_Y, 0);
  EXPECT_NEAR(read().X_MH.p.y(), 0.08, 1e-12);
  kernel.axis(ABS_X, 5000);
  EXPECT_NEAR(read().X_MH.p.x(), 0.08, 1e-12) << "beyond what it says its range is";
  EXPECT_EQ(read().X_MH.p.z(), 0.0);
  EXPECT_TRUE(read().X_MH.q.isApprox(Quat::Identity()));
}

TEST_F(ForceStickDeviceTest, AWheelMovesAlongALine) {
  options.axes = ForceStickAxes::kWheel;
  options.full = {6.0, 0.0};
  kernel.make({BTN_TRIGGER}, {{ABS_X, {-32768, 32767, 0, 0}}, {ABS_Y, {0, 255, 255, 0}}});
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(becomes(true)) << "a pedal at its end is not the wheel";
  kernel.axis(ABS_X, 32767);
  kernel.axis(ABS_Y, 3);
  EXPECT_TRUE(read().X_MH.p.isApprox(Vec3(0.1, 0.0, 0.0)));
  EXPECT_EQ(device->capabilities().max_force, 6.0);
  EXPECT_EQ(device->capabilities().workspace_half, Vec3(0.1, 1e-3, 1e-3));
  device->write({Vec3(6.0, 6.0, 0.0), Vec3::Zero()});
  for (int i = 0; i < 10'000 && kernel.push()[0] < 0.01; ++i) {
    (void)read();
    device->write({Vec3(6.0, 6.0, 0.0), Vec3::Zero()});
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(kernel.effects().size(), 1u);
  EXPECT_GT(kernel.push()[0], 0.0);
}

TEST_F(ForceStickDeviceTest, ItsVelocityFollowsAndComesToRest) {
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(becomes(true));
  // 100 counts in 0.2 s over a way of 0.2 m in 1023 counts: 0.0978 m/s.
  HapticSample last;
  for (int i = 1; i <= 200; ++i) {
    if (i % 2 == 0) kernel.axis(ABS_X, 512 + i / 2);
    last = read();
  }
  EXPECT_NEAR(last.v_MH.x(), 0.0978, 0.01);
  EXPECT_EQ(last.v_MH.y(), 0.0);
  EXPECT_LT(after(0.3).v_MH.norm(), 1e-6);
}

TEST_F(ForceStickDeviceTest, AnAxisThatReadsAsAtItsEndCountsOnceItHasMoved) {
  kernel.make({BTN_TRIGGER}, {{ABS_X, {0, 1023, 0, 0}}, {ABS_Y, {0, 1023, 1023, 0}}});
  ASSERT_NO_FATAL_FAILURE(open());
  EXPECT_FALSE(after(0.1).valid);
  EXPECT_EQ(text_of(device->trouble()).substr(0, 31), "it reads as at its end, as some");
  kernel.axis(ABS_X, 300);
  EXPECT_FALSE(after(0.1).valid) << "Y has not";
  kernel.axis(ABS_Y, 600);
  EXPECT_TRUE(read().valid);
  EXPECT_EQ(read().v_MH.norm(), 0.0) << "it did not leap there";
  kernel.axis(ABS_X, 0);
  EXPECT_TRUE(read().valid) << "it may be at its end later";
}

TEST_F(ForceStickDeviceTest, ButtonsAreThoseOfAJoystick) {
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(becomes(true));
  kernel.key(BTN_THUMB, 1);
  EXPECT_EQ(read().buttons, 1u);
  kernel.key(BTN_THUMB2, 1);
  EXPECT_EQ(read().buttons, 3u);
  kernel.key(BTN_TRIGGER, 1);
  EXPECT_EQ(read().buttons, 7u);
}

TEST_F(ForceStickDeviceTest, DeclaresWhatIsConfiguredAndEveryDelay) {
  options.full = {4.0, -8.0};
  options.upload_period = 2e-3;
  options.most_upload = 3e-3;
  options.delay = 8e-3;
  options.mass = 0.4;
  options.damping = 2.0;
  options.friction = 0.1;
  const HapticCapabilities c = ForceStick(options, kernel).capabilities();
  EXPECT_EQ(c.max_force, 4.0) << "in every direction";
  EXPECT_NEAR(c.dynamics.delay, 13e-3, 1e-12);
  EXPECT_NEAR(c.dynamics.resolution, 0.2 / 1023, 1e-12);
  EXPECT_EQ(c.dynamics.mass, 0.4);
  EXPECT_EQ(c.dynamics.damping, 2.0);
  EXPECT_EQ(c.dynamics.friction, 0.1);
  EXPECT_FALSE(c.simulated);
}

TEST_F(ForceStickDeviceTest, WhatCannotPushOrIsCoarserIsRefused) {
  options.axis_counts = 1024;
  EXPECT_THAT(
      ForceStick(options, kernel).open().message(),
      HasSubstr("/dev/input/event5: its axis X has 1023 counts, and 1024 are reckoned with"));
  options.axis_counts = 1023;
  kernel.give_effect(FF_RUMBLE);
  EXPECT_THAT(ForceStick(options, kernel).open().message(),
              HasSubstr("Made-up pad has no two axes with a constant force; expected a "
                        "force-feedback joystick"));
  kernel.give_effect(FF_CONSTANT);
  kernel.make({BTN_TRIGGER}, {{ABS_X, {0, 1023, 512, 0}}});
  EXPECT_THAT(ForceStick(options, kernel).open().message(), HasSubstr("has no two axes"));
  options.axes = ForceStickAxes::kWheel;
  EXPECT_TRUE(ForceStick(options, kernel).open());
  kernel.refuse(EACCES);
  EXPECT_THAT(ForceStick(options, kernel).open().message(), HasSubstr("usermod -aG input"));
}

TEST_F(ForceStickDeviceTest, UnpluggedItIsNotValidAndComesBackWithoutALeap) {
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(becomes(true));
  kernel.axis(ABS_X, 900);
  EXPECT_GT(read().X_MH.p.x(), 0.07);
  kernel.pull_out();
  ASSERT_TRUE(becomes(false));
  EXPECT_EQ(read().buttons, 0u);
  EXPECT_EQ(text_of(device->trouble()), kUnpluggedInput);
  kernel.plug_in();
  ASSERT_TRUE(becomes(true));
  EXPECT_LT(read().X_MH.p.x(), 0.01);
  EXPECT_LT(read().v_MH.norm(), 1e-6);
}

// With a device that may tell of a place 2 ms late: 20 mm and the computer's own time.
TEST_F(ForceStickDeviceTest, AnAxisThatLeapsIsLostAndComesBackWhereItIs) {
  options.delay = 2e-3;
  for (const bool up : {false, true}) {
    for (const int counts : {1000, 20}) {
      ASSERT_NO_FATAL_FAILURE(open());
      ASSERT_TRUE(becomes(true));
      hand_has(50);
      kernel.axis(ABS_X, 512);
      kernel.axis(ABS_Y, 512);
      ASSERT_TRUE(read().valid);
      // As the kernel has it when it is opened again.
      kernel.make({BTN_TRIGGER}, {{ABS_X, {0, 1023, up ? 512 : counts, 0}},
                                  {ABS_Y, {0, 1023, up ? counts : 512, 0}}});
      const int opened = kernel.opened();
      ASSERT_TRUE(leaps(up ? ABS_Y : ABS_X, counts));
      EXPECT_EQ(read().buttons, 0u);
      const bool positive = (counts > 512) != up;
      EXPECT_THAT(trouble(), HasSubstr(std::string(up ? "its axis Y" : "its axis X") +
                                       " leapt by " + (positive ? "9" : "-9")));
      EXPECT_THAT(trouble(), HasSubstr("m/s, and at most 10 are a hand's; look at its cable"));
      ASSERT_TRUE(becomes(true));
      EXPECT_GE(monotonic_now() - leapt, 100 * kMillisecond) << "or the master would bridge it";
      EXPECT_EQ(kernel.opened(), opened + 1);
      EXPECT_EQ(read().v_MH.norm(), 0.0);
      EXPECT_GT(std::abs(read().X_MH.p[up ? 1 : 0]), 0.09);
    }
  }
}

TEST_F(ForceStickDeviceTest, ALoopThatWasLateTakesNoWayForALeap) {
  options.delay = 0.0;
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(becomes(true));
  hand_has(25);
  kernel.axis(ABS_X, 1000);
  EXPECT_TRUE(read().valid);
}

TEST_F(ForceStickDeviceTest, AfterALeapTheForceBeginsAnew) {
  options.full = {4.0, 4.0};
  options.delay = 2e-3;
  ASSERT_NO_FATAL_FAILURE(open());
  const auto pushes = [this](double least) {
    return comes([&] {
      (void)read();
      device->write({Vec3(4.0, 0.0, 0.0), Vec3::Zero()});
      return kernel.push()[0] >= least;
    });
  };
  ASSERT_TRUE(pushes(0.9));
  // It is let go of while the readings are not valid, whatever is written.
  ASSERT_TRUE(leaps(ABS_X, 1000));
  ASSERT_TRUE(comes([&] {
    device->write({Vec3(4.0, 0.0, 0.0), Vec3::Zero()});
    return kernel.push()[0] == 0.0;
  }));
  EXPECT_TRUE(comes([&] { return !device->pushed().there; })) << "its motors are let go of";
  EXPECT_FALSE(read().valid);
  EXPECT_TRUE(pushes(0.9));
}

TEST_F(ForceStickDeviceTest, LeaptToItsEndItHasToBeMoved) {
  options.delay = 0.0;
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(becomes(true));
  kernel.make({BTN_TRIGGER}, {{ABS_X, {0, 1023, 0, 0}}, {ABS_Y, {0, 1023, 512, 0}}});
  ASSERT_TRUE(leaps(ABS_X, 0));
  ASSERT_TRUE(comes([&] {
    (void)read();
    return trouble().ends_with("look at its cable; then move it once");
  }));
  EXPECT_FALSE(read().valid);
  kernel.axis(ABS_X, 30);
  EXPECT_TRUE(becomes(true));
  kernel.pull_out();
  ASSERT_TRUE(becomes(false));
  EXPECT_EQ(trouble(), kUnpluggedInput) << "the leap is done with";
}

}  // namespace
}  // namespace handrail
