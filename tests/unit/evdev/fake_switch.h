// A foot switch of the kernel's, made up.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <mutex>

#include "tests/support/fake_evdev.h"

namespace handrail::test {

// Answers as the kernel does.
class FakeSwitch final : public FakeEvdev {
 public:
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

 private:
  int grabbed_ = 0;
  bool held_ = false, taken_ = false;
};

}  // namespace handrail::test
