// A foot switch of the kernel's, made up.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <mutex>

#include "devices/evdev/evdev_file.h"

namespace handrail::test {

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

}  // namespace handrail::test
