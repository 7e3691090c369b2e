// Keeps open what can be unplugged, for a thread that must not wait.
#pragma once

#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <functional>
#include <thread>
#include <utility>

#include "devices/input/reopen_pause.h"
#include "server/base/clock.h"
#include "server/base/doorbell.h"
#include "server/base/mailbox.h"
#include "server/base/signals.h"
#include "server/base/status.h"
#include "server/base/time.h"

namespace handrail {

// Opens a device, and again whenever it is lost, in a thread of its own. `Opened` has the
// descriptor as `fd`, and what the device was asked as it was opened; it is copied without
// throwing. One thread uses what is opened; take() and lost() are real-time safe.
template <typename Opened>
class Reopener {
 public:
  // Opens it without waiting for anybody; the descriptor never blocks. Called from one thread at a
  // time.
  using Open = std::function<Result<Opened>()>;

  // `pause`: between two attempts, from a millisecond on.
  explicit Reopener(Open open, Nanos pause = kReopenPause)
      : open_(std::move(open)), pause_(pause) {}
  ~Reopener() { stop(); }
  Reopener(const Reopener&) = delete;
  Reopener& operator=(const Reopener&) = delete;

  // Starts the thread. With `first`, what was opened already; else it is opened there.
  void start(const Opened* first) {
    stop();
    lost_.store(first != nullptr ? kNothing : kNotYet, std::memory_order_relaxed);
    stopping_.store(false, std::memory_order_relaxed);
    if (first != nullptr) opened_.publish(*first);
    const SignalsBlocked blocked;
    thread_ = std::thread([this] { run(); });
  }
  // Takes what was opened since the last, if anything was: it is the caller's until it is lost.
  bool take(Opened& out) noexcept { return opened_.take(out); }
  // Gives back what does not work any more: it is closed, and opened again as soon as it can be.
  void lost(int fd) noexcept {
    lost_.store(fd, std::memory_order_release);
    bell_.ring();
  }
  // Ends the thread; closes what nobody took. What was taken stays its taker's. Twice is fine.
  void stop() noexcept {
    if (!thread_.joinable()) return;
    stopping_.store(true, std::memory_order_relaxed);
    bell_.ring();
    thread_.join();
    Opened left;
    if (opened_.take(left)) ::close(left.fd);
    const int fd = lost_.exchange(kNothing, std::memory_order_acquire);
    if (fd >= 0) ::close(fd);
  }

 private:
  // In place of a descriptor, of which none is negative.
  static constexpr int kNothing = -1;  // was lost
  static constexpr int kNotYet = -2;   // opened, and so there is nothing to close

  void run() {
    bool wanted = false;
    Nanos next = -kForever;
    while (!stopping_.load(std::memory_order_relaxed)) {
      const int fd = lost_.exchange(kNothing, std::memory_order_acquire);
      if (fd >= 0) ::close(fd);
      wanted = wanted || fd != kNothing;
      // What opens and is lost at once is not called more often either.
      if (wanted && monotonic_now() >= next) {
        next = monotonic_now() + pause_;
        if (Result<Opened> opened = open_()) {
          opened_.publish(*opened);
          wanted = false;
        }
      }
      pollfd rung{bell_.fd(), POLLIN, 0};
      ::poll(&rung, 1, static_cast<int>(pause_ / kMillisecond));
      (void)bell_.answer();
    }
  }

  Open open_;
  Nanos pause_;
  Doorbell bell_;
  Mailbox<Opened> opened_;
  std::atomic<int> lost_{kNothing};
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace handrail
