// An input device of the kernel's, made up.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cerrno>
#include <mutex>

#include "devices/evdev/evdev_file.h"

namespace handrail::test {

// Its events come through a pipe. What it answers is for who derives from it. Used by the thread
// that opens and by the test.
class FakeEvdev : public EvdevKernel {
 public:
  ~FakeEvdev() override { unplug(); }

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
  int opened() {
    const std::lock_guard lock(mutex_);
    return opened_;
  }

 protected:
  std::mutex mutex_;

 private:
  int writes_ = -1, refuses_ = 0, opened_ = 0;
};

}  // namespace handrail::test
