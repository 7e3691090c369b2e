// The motors of a device of uinput: answers what the kernel asks.
#pragma once

#include <linux/uinput.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <atomic>
#include <map>
#include <mutex>
#include <thread>

#include "server/base/clock.h"
#include "server/base/pacer.h"

namespace handrail::kernel {

// Keeps what it is told in a thread of its own, until it is destroyed, before its device.
class UinputMotors {
 public:
  struct Effect {
    int type = 0, direction = 0, level = 0, lasts = 0;
    bool on = false;
  };

  explicit UinputMotors(int fd) : fd_(fd), thread_([this] { run(); }) {}
  ~UinputMotors() {
    stopping_.store(true);
    thread_.join();
  }
  UinputMotors(const UinputMotors&) = delete;
  UinputMotors& operator=(const UinputMotors&) = delete;

  std::map<int, Effect> effects() {
    const std::lock_guard lock(mutex_);
    return effects_;
  }
  // What pulls in that direction now, as a level; 0: nothing.
  int pull(int direction) {
    const std::lock_guard lock(mutex_);
    int out = 0;
    for (const auto& [id, e] : effects_) out += e.on && e.direction == direction ? e.level : 0;
    return out;
  }
  // -1: it was not set.
  int gain() const { return gain_; }
  int centring() const { return centring_; }
  int erased() const { return erased_; }
  int uploads() const { return uploads_; }
  // Each upload takes so long.
  void slow(Nanos time) { slow_ = time; }

 private:
  void run() {
    while (!stopping_.load()) {
      pollfd waits{fd_, POLLIN, 0};
      if (::poll(&waits, 1, 20) != 1) continue;
      input_event event{};
      if (::read(fd_, &event, sizeof event) != static_cast<ssize_t>(sizeof event)) continue;
      if (event.type == EV_UINPUT && event.code == UI_FF_UPLOAD) upload(event.value);
      if (event.type == EV_UINPUT && event.code == UI_FF_ERASE) erase(event.value);
      if (event.type == EV_FF) told(event);
    }
  }
  void upload(int request) {
    uinput_ff_upload asked{};
    asked.request_id = static_cast<__u32>(request);
    if (::ioctl(fd_, UI_BEGIN_FF_UPLOAD, &asked) != 0) return;
    if (slow_ > 0) sleep_until(monotonic_now() + slow_);
    {
      const std::lock_guard lock(mutex_);
      Effect& kept = effects_[asked.effect.id];
      kept.type = asked.effect.type;
      kept.direction = asked.effect.direction;
      kept.level = asked.effect.u.constant.level;
      kept.lasts = asked.effect.replay.length;
    }
    ++uploads_;
    asked.retval = 0;
    ::ioctl(fd_, UI_END_FF_UPLOAD, &asked);
  }
  void erase(int request) {
    uinput_ff_erase asked{};
    asked.request_id = static_cast<__u32>(request);
    if (::ioctl(fd_, UI_BEGIN_FF_ERASE, &asked) != 0) return;
    {
      const std::lock_guard lock(mutex_);
      effects_.erase(static_cast<int>(asked.effect_id));
    }
    ++erased_;
    asked.retval = 0;
    ::ioctl(fd_, UI_END_FF_ERASE, &asked);
  }
  void told(const input_event& event) {
    if (event.code == FF_GAIN) gain_ = event.value;
    if (event.code == FF_AUTOCENTER) centring_ = event.value;
    if (event.code >= FF_MAX_EFFECTS) return;
    const std::lock_guard lock(mutex_);
    if (const auto found = effects_.find(event.code); found != effects_.end()) {
      found->second.on = event.value != 0;
    }
  }

  int fd_;
  std::atomic<bool> stopping_{false};
  std::atomic<int> gain_{-1}, centring_{-1}, erased_{0}, uploads_{0};
  std::atomic<Nanos> slow_{0};
  std::mutex mutex_;
  std::map<int, Effect> effects_;
  std::thread thread_;  // last: it uses the others
};

}  // namespace handrail::kernel
