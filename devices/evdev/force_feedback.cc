#include "devices/evdev/force_feedback.h"

#include <pthread.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdint>
#include <utility>

#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "server/base/realtime.h"
#include "server/base/signals.h"

namespace handrail {
namespace {

// As long as the longest of our effects lasts by itself (Rumble::kRumbleLasts): later nothing acts,
// whatever the device's driver is doing.
constexpr Nanos kEndPatience = 200 * kMillisecond;
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

void FeedbackThread::start(std::shared_ptr<FeedbackWork> work) {
  stop();
  turns_ = std::make_shared<Turns>();
  turns_->work = std::move(work);
  turns_->period = period_;
  turns_->priority = priority_;
  const SignalsBlocked blocked;
  running_.fetch_add(1, std::memory_order_relaxed);
  thread_ = std::thread([turns = turns_] {
    run(*turns);
    turns->ended.store(true, std::memory_order_release);
    running_.fetch_sub(1, std::memory_order_release);
  });
}

void FeedbackThread::stop() noexcept {
  if (!thread_.joinable()) return;
  turns_->stopping.store(true, std::memory_order_relaxed);
  const Nanos until = monotonic_now() + kEndPatience;
  const auto ended = [this] { return turns_->ended.load(std::memory_order_acquire); };
  while (!ended() && monotonic_now() < until) sleep_until(monotonic_now() + kMillisecond);
  ended() ? thread_.join() : thread_.detach();
}

void FeedbackThread::run(Turns& turns) noexcept {
  if (turns.priority > 0) {
    (void)enter_realtime(turns.priority);
  } else {
    become_unimportant();
  }
  while (!turns.stopping.load(std::memory_order_relaxed)) {
    const Nanos now = monotonic_now();
    if (FixedText<256> path; turns.path.take(path)) turns.work->use(path);
    turns.work->turn(now);
    sleep_until(now + turns.period);
  }
  turns.work->end();
}

}  // namespace handrail
