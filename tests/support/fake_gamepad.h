// A gamepad of the kernel's, made up.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <climits>
#include <cstring>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

#include "tests/support/fake_evdev.h"

namespace handrail::test {

// Answers as the kernel does.
class FakeGamepad : public FakeEvdev {
 public:
  struct Axis {
    int least, most, value, flat;
  };

  // What its motors were told, newest last.
  struct Motors {
    int strong, weak, lasts;  // [counts], [ms]
    bool on;
  };

  int open_to_write(const char* path) noexcept override {
    const std::lock_guard lock(mutex_);
    if (!may_write_) {
      errno = EACCES;
      return -1;
    }
    written_path_ = path;
    return ::open("/dev/null", O_RDWR | O_CLOEXEC);
  }
  bool write(int, const input_event& event) noexcept override {
    const std::lock_guard lock(mutex_);
    EXPECT_EQ(event.type, EV_FF);
    EXPECT_EQ(event.code, kEffect);
    motors_.push_back(uploaded_);
    motors_.back().on = event.value != 0;
    return true;
  }
  void make_motors(bool may_write = true) {
    const std::lock_guard lock(mutex_);
    has_motors_ = true;
    may_write_ = may_write;
  }
  // What the motors do, in place of FF_RUMBLE.
  void give_effect(int effect) {
    const std::lock_guard lock(mutex_);
    motor_effect_ = effect;
  }
  // Each upload takes so long.
  void slow(std::chrono::milliseconds time) { slow_ = time; }
  std::vector<Motors> motors() {
    const std::lock_guard lock(mutex_);
    return motors_;
  }
  // As the kernel does with those of a device that is gone.
  void forget_effects() {
    const std::lock_guard lock(mutex_);
    uploads_ = 0;
  }
  int uploads() {
    const std::lock_guard lock(mutex_);
    return uploads_;
  }
  std::string written_path() {
    const std::lock_guard lock(mutex_);
    return written_path_;
  }

  int control(int, unsigned long request, void* argument) noexcept override {
    const auto number = _IOC_NR(request);
    if (number == 0x80) std::this_thread::sleep_for(upload_time());
    const std::lock_guard lock(mutex_);
    if (number == 0x80) {  // EVIOCSFF
      auto& effect = *static_cast<ff_effect*>(argument);
      EXPECT_EQ(effect.type, FF_RUMBLE);
      EXPECT_EQ(effect.id, uploads_ == 0 ? -1 : kEffect) << "one effect, changed";
      effect.id = kEffect;
      ++uploads_;
      uploaded_ = {effect.u.rumble.strong_magnitude, effect.u.rumble.weak_magnitude,
                   effect.replay.length, false};
      return 0;
    }
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
    if (number == 0x20 + EV_FF && has_motors_) set(argument, motor_effect_);
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

 protected:
  std::chrono::milliseconds upload_time() const { return slow_.load(); }

 private:
  static void set(void* words, int bit) {
    constexpr int kBits = sizeof(unsigned long) * CHAR_BIT;
    static_cast<unsigned long*>(words)[bit / kBits] |= 1ul << bit % kBits;
  }
  static constexpr int kEffect = 3;
  bool has_motors_ = false, may_write_ = true;
  int motor_effect_ = FF_RUMBLE;
  std::atomic<std::chrono::milliseconds> slow_{std::chrono::milliseconds(0)};
  Motors uploaded_{};
  std::vector<Motors> motors_;
  int uploads_ = 0;
  std::string written_path_;
  std::vector<int> keys_, held_;
  std::map<int, Axis> axes_;
};

}  // namespace handrail::test
