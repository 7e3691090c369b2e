#include "devices/evdev/stop_switch.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <mutex>
#include <thread>
#include <vector>

#include "tests/support/no_allocation.h"
#include "tests/unit/evdev/fake_switch.h"

namespace handrail {
namespace {

using test::FakeSwitch;
using ::testing::HasSubstr;

class StopSwitchTest : public ::testing::Test {
 protected:
  void start() {
    const Status status = stop.start();
    ASSERT_TRUE(status.is_ok()) << status.message();
  }
  // For at most ten seconds.
  bool becomes(bool open) {
    for (int i = 0; i < 10'000; ++i) {
      if (stop.is_open() == open) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }

  FakeSwitch kernel;
  StopSwitch stop{{"/dev/input/foot", KEY_A, kMillisecond}, kernel};
};

TEST_F(StopSwitchTest, ItIsOpenWhileTheKeyIsDown) {
  EXPECT_TRUE(stop.is_open()) << "not started";
  start();
  EXPECT_FALSE(stop.is_open());
  EXPECT_EQ(kernel.grabbed(), 1) << "what it types must reach nobody else";
  kernel.key(KEY_A, 1);
  EXPECT_TRUE(stop.is_open());
  kernel.key(KEY_A, 2);
  EXPECT_TRUE(stop.is_open());
  kernel.key(KEY_A, 0);
  EXPECT_FALSE(stop.is_open());
  stop.stop();
  EXPECT_TRUE(stop.is_open());
}

TEST_F(StopSwitchTest, APressBetweenTwoCallsIsToldOnce) {
  start();
  ASSERT_FALSE(stop.is_open());
  kernel.key(KEY_A, 1);
  kernel.key(KEY_A, 0);
  EXPECT_TRUE(stop.is_open());
  EXPECT_FALSE(stop.is_open());
}

TEST_F(StopSwitchTest, AKeyThatIsDownAsItIsOpenedCounts) {
  kernel.hold(true);
  start();
  EXPECT_TRUE(stop.is_open());
  kernel.key(KEY_A, 0);
  EXPECT_FALSE(stop.is_open());
}

TEST_F(StopSwitchTest, OnlyTheConfiguredKeyStopsOrElseAny) {
  start();
  kernel.key(KEY_B, 1);
  EXPECT_FALSE(stop.is_open());
  FakeSwitch other;
  StopSwitch any({"/dev/input/foot", std::nullopt}, other);
  ASSERT_TRUE(any.start().is_ok());
  EXPECT_FALSE(any.is_open());
  other.key(KEY_B, 1);
  EXPECT_TRUE(any.is_open());
}

TEST_F(StopSwitchTest, UnpluggedAHundredTimesItIsOpenUntilItIsBack) {
  start();
  ASSERT_FALSE(stop.is_open());
  for (int i = 0; i < 100; ++i) {
    kernel.unplug();
    ASSERT_TRUE(stop.is_open()) << i;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    ASSERT_TRUE(stop.is_open()) << i;
    kernel.refuse(0);
    ASSERT_TRUE(becomes(false)) << i;
  }
  EXPECT_EQ(kernel.grabbed(), kernel.opened());
}

// What was missed may have been the press: it is asked anew.
TEST_F(StopSwitchTest, AfterEventsThatAreMissingItIsOpenUntilTheKeyIsAsked) {
  start();
  ASSERT_FALSE(stop.is_open());
  kernel.hold(true);
  kernel.event(EV_SYN, SYN_DROPPED, 0);
  EXPECT_TRUE(stop.is_open());
  for (int i = 0; kernel.opened() < 2 && i < 10'000; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ASSERT_EQ(kernel.opened(), 2);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_TRUE(stop.is_open());
  kernel.key(KEY_A, 0);
  EXPECT_TRUE(becomes(false));
}

TEST_F(StopSwitchTest, AskingDoesNotAllocate) {
  start();
  kernel.key(KEY_A, 1);
  const test::NoAllocation guard("stop switch");
  for (int i = 0; i < 100; ++i) (void)stop.is_open();
}

TEST_F(StopSwitchTest, WhatCannotBeOpenedSaysWhyAndWhatToDo) {
  kernel.refuse(ENOENT);
  EXPECT_THAT(stop.start().message(), HasSubstr("/dev/input/foot: cannot be opened: No such file"));
  kernel.refuse(EACCES);
  EXPECT_THAT(stop.start().message(), HasSubstr("usermod -aG input"));
  kernel.refuse(0);
  kernel.take(true);
  EXPECT_THAT(stop.start().message(), HasSubstr("another program has grabbed it"));
  EXPECT_TRUE(stop.is_open());
}

TEST_F(StopSwitchTest, ADeviceWithoutTheKeyIsRefused) {
  StopSwitch other({"/dev/input/foot", KEY_C}, kernel);
  EXPECT_THAT(other.start().message(), HasSubstr("(Foot switch) has no key 46"));
}

TEST(EvdevFile, AFileThatIsNoInputDeviceIsRefused) {
  const Result<EvdevOpened> opened = open_evdev(evdev_kernel(), "/dev/null", EvdevUse::kShare);
  EXPECT_THAT(opened.message(), HasSubstr("/dev/null: cannot be used"));
  EXPECT_THAT(opened.message(), HasSubstr("expected an input device"));
}

}  // namespace
}  // namespace handrail
