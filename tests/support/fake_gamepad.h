// A gamepad of the kernel's, made up.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstring>
#include <map>
#include <mutex>
#include <vector>

#include "tests/support/fake_evdev.h"

namespace handrail::test {

// Answers as the kernel does.
class FakeGamepad final : public FakeEvdev {
 public:
  struct Axis {
    int least, most, value, flat;
  };

  int control(int, unsigned long request, void* argument) noexcept override {
    const std::lock_guard lock(mutex_);
    const auto number = _IOC_NR(request);
    if (number == 0x06) {  // EVIOCGNAME of any length
      std::strcpy(static_cast<char*>(argument), "Made-up pad");
      return 12;
    }
    if (number >= 0x40 && number < 0x40 + ABS_CNT) {  // EVIOCGABS
      const Axis& axis = axes_.at(static_cast<int>(number - 0x40));
      *static_cast<input_absinfo*>(argument) = {axis.value, axis.least, axis.most, 0, axis.flat, 0};
      return 0;
    }
    std::memset(argument, 0, _IOC_SIZE(request));
    if (number == 0x20 + EV_KEY) {
      for (const int key : keys_) set(argument, key);
    }
    if (number == 0x20 + EV_ABS) {
      for (const auto& [code, axis] : axes_) set(argument, code);
    }
    if (number == 0x18) {  // EVIOCGKEY
      for (const int key : held_) set(argument, key);
    }
    return 0;
  }

  // As it is plugged in: its keys, and its axes.
  void make(std::vector<int> keys, std::map<int, Axis> axes) {
    const std::lock_guard lock(mutex_);
    keys_ = std::move(keys);
    axes_ = std::move(axes);
  }
  void make_pad() {
    const Axis stick{-32768, 32767, 0, 0};
    make({BTN_SOUTH, BTN_TL, BTN_TR},
         {{ABS_X, stick}, {ABS_Y, stick}, {ABS_RX, stick}, {ABS_RY, stick}});
  }
  void hold(std::vector<int> keys) {
    const std::lock_guard lock(mutex_);
    held_ = std::move(keys);
  }
  void axis(unsigned code, int value) {
    event(EV_ABS, code, value);
    event(EV_SYN, SYN_REPORT, 0);
  }
  void drop() {
    event(EV_SYN, SYN_DROPPED, 0);
    event(EV_SYN, SYN_REPORT, 0);
  }

 private:
  static void set(void* words, int bit) {
    constexpr int kBits = sizeof(unsigned long) * CHAR_BIT;
    static_cast<unsigned long*>(words)[bit / kBits] |= 1ul << bit % kBits;
  }
  std::vector<int> keys_, held_;
  std::map<int, Axis> axes_;
};

}  // namespace handrail::test
