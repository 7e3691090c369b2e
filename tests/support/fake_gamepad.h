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

#include "devices/evdev/evdev_file.h"

namespace handrail::test {

// Its events come through a pipe. Answers as the kernel does; used by the
// thread that opens and by the test.
class FakeGamepad final : public EvdevKernel {
 public:
  struct Axis {
    int least, most, value, flat;
  };

  ~FakeGamepad() override { unplug(); }

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
  void report(std::vector<input_event> events) {
    const std::lock_guard lock(mutex_);
    events.push_back(event_of(EV_SYN, SYN_REPORT, 0));
    for (const input_event& event : events) {
      ASSERT_EQ(::write(writes_, &event, sizeof event), static_cast<ssize_t>(sizeof event));
    }
  }
  void axis(unsigned code, int value) { report({event_of(EV_ABS, code, value)}); }
  void key(unsigned code, int value) { report({event_of(EV_KEY, code, value)}); }
  void drop() { report({event_of(EV_SYN, SYN_DROPPED, 0)}); }
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
  int opened() {
    const std::lock_guard lock(mutex_);
    return opened_;
  }

 private:
  static void set(void* words, int bit) {
    constexpr int kBits = sizeof(unsigned long) * CHAR_BIT;
    static_cast<unsigned long*>(words)[bit / kBits] |= 1ul << bit % kBits;
  }
  static input_event event_of(unsigned type, unsigned code, int value) {
    input_event event{};
    event.type = static_cast<std::uint16_t>(type);
    event.code = static_cast<std::uint16_t>(code);
    event.value = value;
    return event;
  }

  std::mutex mutex_;
  std::vector<int> keys_, held_;
  std::map<int, Axis> axes_;
  int writes_ = -1, refuses_ = 0, opened_ = 0;
};

}  // namespace handrail::test
