#include "devices/evdev/force_feedback.h"

#include <pthread.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdint>

#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "server/base/realtime.h"
#include "server/base/signals.h"

namespace handrail {
namespace {

constexpr int kFeedbackNice = 10;  // of 19, behind all that is not told otherwise; our choice

// The thread that starts this one may be a real-time one, and is not to be kept waiting by it.
void become_unimportant() {
  sched_param none{};
  (void)pthread_setschedparam(pthread_self(), SCHED_OTHER, &none);
  (void)::setpriority(PRIO_PROCESS, static_cast<id_t>(::syscall(SYS_gettid)), kFeedbackNice);
}

}  // namespace

bool ForceFeedback::open(const char* path) noexcept {
  close();
  fd_ = kernel_.open_to_write(path);
  return is_open();
}

bool ForceFeedback::upload(ff_effect& effect) noexcept {
  return is_open() && kernel_.control(fd_, EVIOCSFF, &effect) >= 0;
}

bool ForceFeedback::play(const ff_effect& effect, bool on) noexcept {
  return effect.id >= 0 && write(effect.id, on ? 1 : 0);
}

bool ForceFeedback::write(int code, int value) noexcept {
  if (!is_open()) return false;
  input_event event{};
  event.type = EV_FF;
  event.code = static_cast<std::uint16_t>(code);
  event.value = value;
  return kernel_.write(fd_, event);
}

void ForceFeedback::erase(ff_effect& effect) noexcept {
  if (is_open() && effect.id >= 0) {
    // The kernel takes the number itself, not where it is.
    (void)kernel_.control(fd_, EVIOCRMFF,
                          reinterpret_cast<void*>(static_cast<std::intptr_t>(effect.id)));
  }
  effect.id = -1;
}

void ForceFeedback::close() noexcept {
  if (is_open()) ::close(fd_);
  fd_ = -1;
}

void FeedbackThread::start() {
  stop();
  stopping_.store(false, std::memory_order_relaxed);
  const SignalsBlocked blocked;
  thread_ = std::thread([this] { run(); });
}

void FeedbackThread::stop() noexcept {
  if (!thread_.joinable()) return;
  stopping_.store(true, std::memory_order_relaxed);
  thread_.join();
}

void FeedbackThread::run() noexcept {
  if (priority_ > 0) {
    (void)enter_realtime(priority_);
  } else {
    become_unimportant();
  }
  while (!stopping_.load(std::memory_order_relaxed)) {
    const Nanos now = monotonic_now();
    if (FixedText<256> path; path_.take(path)) work_.use(path);
    work_.turn(now);
    sleep_until(now + period_);
  }
  work_.end();
}

}  // namespace handrail
