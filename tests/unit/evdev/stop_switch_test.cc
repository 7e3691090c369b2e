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

namespace handrail {
namespace {

using ::testing::HasSubstr;

// A foot switch whose events come through a pipe. Answers as the kernel does; used by the thread
// that opens and by the test.
class FakeSwitch final : public EvdevKernel {
 public:
  ~FakeSwitch() override { unplug(); }

  int open(const char*) noexcept override {
    const std::lock_guard lock(mutex_);
    if (refuses_ != 0) {
      errno = refuses_;
      return -1;
    }
    int ends[2];
    if (::pipe2(ends, O_NONBLOCK | O_CLOEXEC) != 0) return -1;
    if (writes_ >= 0) ::close(writes_);
    writes_ = ends[1];
    ++opened_;
    return ends[0];
  }
  int control(int, unsigned long request, void* argument) noexcept override {
    const std::lock_guard lock(mutex_);
    if (request == EVIOCGRAB) {
      ++grabbed_;
      if (taken_) {
        errno = EBUSY;
        return -1;
      }
      return 0;
    }
    if (_IOC_NR(request) == 0x06) {  // EVIOCGNAME of any length
      std::strcpy(static_cast<char*>(argument), "Foot switch");
      return 12;
    }
    std::memset(argument, 0, _IOC_SIZE(request));
    auto* words = static_cast<unsigned long*>(argument);
    if (_IOC_NR(request) == 0x20 + EV_KEY) words[0] = 1ul << KEY_A | 1ul << KEY_B;
    if (_IOC_NR(request) == 0x18) words[0] = held_ ? 1ul << KEY_A : 0;  // EVIOCGKEY
    return 0;
  }

  void event(unsigned type, unsigned code, int value) {
    const std::lock_guard lock(mutex_);
    input_event event{};
    event.type = static_cast<std::uint16_t>(type);
    event.code = static_cast<std::uint16_t>(code);
    event.value = value;
    ASSERT_EQ(::write(writes_, &event, sizeof event), static_cast<ssize_t>(sizeof event));
  }
  void key(unsigned code, int value) {
    event(EV_KEY, code, value);
    event(EV_SYN, SYN_REPORT, 0);
  }
  // Nothing is there to be opened until refuse(0).
  void unplug() {
    refuse(ENOENT);
    const std::lock_guard lock(mutex_);
    if (writes_ >= 0) ::close(writes_);
    writes_ = -1;
  }
  void refuse(int error) {
    const std::lock_guard lock(mutex_);
    refuses_ = error;
  }
  void hold(bool held) {
    const std::lock_guard lock(mutex_);
    held_ = held;
  }
  void take(bool taken) {
    const std::lock_guard lock(mutex_);
    taken_ = taken;
  }
  int grabbed() {
    const std::lock_guard lock(mutex_);
    return grabbed_;
  }
  int opened() {
    const std::lock_guard lock(mutex_);
    return opened_;
  }

 private:
  std::mutex mutex_;
  int writes_ = -1, refuses_ = 0, grabbed_ = 0, opened_ = 0;
  bool held_ = false, taken_ = false;
};

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
  StopSwitch stop{{"/dev/input/foot", KEY_A}, kernel};
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

TEST_F(StopSwitchTest, UnpluggedItIsOpenUntilItIsBack) {
  start();
  ASSERT_FALSE(stop.is_open());
  for (int i = 0; i < 5; ++i) {
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
