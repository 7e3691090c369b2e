#include "server/daemon/daemon_log.h"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <spdlog/async_logger.h>
#include <spdlog/details/thread_pool.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/null_sink.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <climits>
#include <semaphore>
#include <string_view>

#include "server/base/clock.h"
#include "server/base/signals_blocked.h"

namespace handrail {
namespace {

// Between two looks whether the program ends, while nobody takes a line.
constexpr Nanos kLook = 20 * kMillisecond;
// Before the next try where poll() promised more than there was.
constexpr int kPauseMs = 1;
// For the log's thread to see that its time is over: a look, and 1024 lines at some 10 us.
constexpr Nanos kEndGrace = 100 * kMillisecond;

// Used by the log's thread alone, but for end_by(), drained_by() and the count of lost lines.
class FdSink final : public spdlog::sinks::base_sink<spdlog::details::null_mutex> {
 public:
  explicit FdSink(int fd) : fd_(fd) {
    struct stat what {};
    if (::fstat(fd, &what) != 0) return;
    socket_ = S_ISSOCK(what.st_mode);
    // O_NONBLOCK belongs to all who share a description; so it gets one of its own.
    if (!S_ISFIFO(what.st_mode) && ::isatty(fd) == 0) return;
    own_ = ::open(("/proc/self/fd/" + std::to_string(fd)).c_str(),
                  O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  }
  ~FdSink() override {
    if (own_ >= 0) ::close(own_);
  }

  void end_by(Nanos at) noexcept { end_by_ = at; }
  // Whether all that was logged before a flush has been dealt with.
  bool drained_by(Nanos at) noexcept {
    return drained_.try_acquire_for(
        std::chrono::nanoseconds(std::max<Nanos>(at - monotonic_now(), 0)));
  }
  void lose() noexcept { ++lost_; }
  std::uint64_t lost() const noexcept { return lost_; }

 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    spdlog::memory_buf_t line;
    formatter_->format(message, line);
    if (!give({line.data(), line.size()})) ++lost_;
  }
  void flush_() override { drained_.release(); }

  // What is free at once is taken at once.
  bool give(std::string_view text) noexcept {
    while (!text.empty()) {
      if (!writable()) return false;
      const ssize_t count = put(text.substr(0, PIPE_BUF));
      if (count > 0) {
        text.remove_prefix(static_cast<std::size_t>(count));
      } else if (count < 0 && errno == EAGAIN) {
        // Another program was quicker.
        if (monotonic_now() > end_by_) return false;
        ::poll(nullptr, 0, kPauseMs);
      } else if (count < 0 && errno != EINTR) {
        return false;
      }
    }
    return true;
  }

  ssize_t put(std::string_view text) const noexcept {
    if (socket_) return ::send(fd_, text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    return ::write(own_ >= 0 ? own_ : fd_, text.data(), text.size());
  }

  bool writable() const noexcept {
    for (;;) {
      const Nanos left = std::clamp<Nanos>(end_by_ - monotonic_now(), 0, kLook);
      pollfd wanted{own_ >= 0 ? own_ : fd_, POLLOUT, 0};
      const int ready = ::poll(&wanted, 1, static_cast<int>(left / kMillisecond));
      if (ready > 0) return true;  // or broken, as write() will say
      if (left == 0) return false;
    }
  }

  const int fd_;
  int own_ = -1;  // the same, without waiting; -1: it is none of those, or may not be opened
  bool socket_ = false;
  std::atomic<Nanos> end_by_{kForever};
  std::atomic<std::uint64_t> lost_{0};
  std::counting_semaphore<> drained_{0};
};

void begin_log_thread(int priority) {
  const sched_param wanted{priority};
  (void)::sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &wanted);
}

}  // namespace

struct DaemonLog::Impl {
  Impl(int fd, int priority) : sink(std::make_shared<FdSink>(fd)) {
    const SignalsBlocked blocked;
    thread = std::make_shared<spdlog::details::thread_pool>(
        kLines, 1, [priority] { begin_log_thread(priority); });
  }

  std::shared_ptr<FdSink> sink;
  std::shared_ptr<spdlog::details::thread_pool> thread;
  std::shared_ptr<spdlog::logger> logger;
};

DaemonLog::DaemonLog(const std::string& name, int priority, int fd)
    : impl_(std::make_unique<Impl>(fd, priority)) {
  ::signal(SIGPIPE, SIG_IGN);
  impl_->logger = std::make_shared<spdlog::async_logger>(
      name, impl_->sink, impl_->thread, spdlog::async_overflow_policy::overrun_oldest);
  // spdlog's own would wait for standard error in the caller's thread.
  impl_->logger->set_error_handler([sink = impl_->sink](const std::string&) { sink->lose(); });
  spdlog::set_default_logger(impl_->logger);
}

DaemonLog::~DaemonLog() {
  const Nanos end = monotonic_now() + kEndPatience;
  impl_->sink->end_by(end);
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("", std::make_shared<spdlog::sinks::null_sink_mt>()));
  impl_->logger->flush();  // behind all lines
  if (impl_->sink->drained_by(end + kEndGrace)) {
    impl_->thread.reset();
  } else {
    // Never freed, for its destructor waits: the thread ends with the process.
    (void)new std::shared_ptr(std::move(impl_->thread));
  }
}

std::uint64_t DaemonLog::lost() const noexcept {
  return impl_->sink->lost() + impl_->thread->overrun_counter();
}

}  // namespace handrail
