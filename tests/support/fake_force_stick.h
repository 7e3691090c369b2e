// A force-feedback joystick of the kernel's, made up.
#pragma once

#include <array>
#include <map>
#include <set>
#include <vector>

#include "tests/support/fake_gamepad.h"

namespace handrail::test {

// Keeps effects as the kernel does: an id each, as many as it has slots for, gone with its device.
class FakeForceStick final : public FakeGamepad {
 public:
  struct Effect {
    int direction = 0, level = 0, lasts = 0;  // the kernel's, [counts], [ms]
    bool on = false;
    int plays = 0;
  };

  FakeForceStick() {
    make({BTN_TRIGGER, BTN_THUMB, BTN_THUMB2},
         {{ABS_X, {0, 1023, 512, 0}}, {ABS_Y, {0, 1023, 512, 0}}});
    give_effect(FF_CONSTANT);
    make_motors();
  }

  int control(int fd, unsigned long request, void* argument) noexcept override {
    const auto number = _IOC_NR(request);
    if (number == 0x80) return upload(fd, *static_cast<ff_effect*>(argument));
    if (number == 0x81) {  // EVIOCRMFF: the number itself
      const std::lock_guard lock(mutex_);
      const auto id = static_cast<int>(reinterpret_cast<std::intptr_t>(argument));
      if (!live_.contains(fd)) return -1;
      return effects_.erase(id) == 1 ? ++erased_, 0 : -1;
    }
    return FakeGamepad::control(fd, request, argument);
  }
  int open_to_write(const char* path) noexcept override {
    const int fd = FakeGamepad::open_to_write(path);
    const std::lock_guard lock(mutex_);
    if (fd >= 0 && !gone_) live_.insert(fd);
    return fd;
  }
  bool write(int fd, const input_event& event) noexcept override {
    const std::lock_guard lock(mutex_);
    EXPECT_EQ(event.type, EV_FF);
    if (!live_.contains(fd)) return false;
    if (event.code >= FF_MAX_EFFECTS) {
      set_[event.code] = event.value;
      return true;
    }
    EXPECT_TRUE(effects_.contains(event.code)) << event.code;
    Effect& effect = effects_[event.code];
    effect.on = event.value != 0;
    effect.plays += effect.on ? 1 : 0;
    plays_ += effect.on ? 1 : 0;
    return true;
  }

  // What pushes along the kernel's axes now, in shares of the full level: right and up.
  std::array<double, 2> push() {
    const std::lock_guard lock(mutex_);
    std::array<double, 2> out{};
    for (const auto& [id, e] : effects_) {
      if (!e.on) continue;
      if (e.direction == 0xC000) out[0] += e.level / 32767.0;
      if (e.direction == 0x4000) out[0] -= e.level / 32767.0;
      if (e.direction == 0x8000) out[1] += e.level / 32767.0;
      if (e.direction == 0x0000) out[1] -= e.level / 32767.0;
    }
    return out;
  }
  std::map<int, Effect> effects() {
    const std::lock_guard lock(mutex_);
    return effects_;
  }
  // Times that any effect was played, those that are erased among them.
  int plays() {
    const std::lock_guard lock(mutex_);
    return plays_;
  }
  int erased() {
    const std::lock_guard lock(mutex_);
    return erased_;
  }
  // FF_GAIN and FF_AUTOCENTER as they were set; -1: not at all.
  int was_set(int code) {
    const std::lock_guard lock(mutex_);
    return set_.contains(code) ? set_[code] : -1;
  }
  // So many effects have room.
  void slots(int count) {
    const std::lock_guard lock(mutex_);
    slots_ = count;
  }
  // The next uploads are refused, so many.
  void refuse_uploads(int count) {
    const std::lock_guard lock(mutex_);
    refused_ = count;
  }
  void pull_out() {
    {
      const std::lock_guard lock(mutex_);
      gone_ = true;
      effects_.clear();
      live_.clear();
    }
    unplug();
  }
  void plug_in() {
    {
      const std::lock_guard lock(mutex_);
      gone_ = false;
    }
    refuse(0);
  }

 private:
  int upload(int fd, ff_effect& effect) {
    std::this_thread::sleep_for(upload_time());
    const std::lock_guard lock(mutex_);
    if (!live_.contains(fd) || refused_ > 0) {
      if (refused_ > 0) --refused_;
      errno = live_.contains(fd) ? EIO : ENODEV;
      return -1;
    }
    EXPECT_EQ(effect.type, FF_CONSTANT);
    if (effect.id < 0) {
      if (static_cast<int>(effects_.size()) >= slots_) {
        errno = ENOSPC;
        return -1;
      }
      effect.id = 0;
      while (effects_.contains(effect.id)) ++effect.id;
    } else if (!effects_.contains(effect.id)) {
      errno = EINVAL;
      return -1;
    }
    Effect& kept = effects_[effect.id];
    kept.direction = effect.direction;
    kept.level = effect.u.constant.level;
    kept.lasts = effect.replay.length;
    return 0;
  }

  std::map<int, Effect> effects_;
  std::set<int> live_;  // descriptors of the device as it is plugged in
  std::map<int, int> set_;
  int erased_ = 0, plays_ = 0, slots_ = 16, refused_ = 0;
  bool gone_ = false;
};

}  // namespace handrail::test
