#include "server/daemon/daemon_log.h"

#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <spdlog/async_logger.h>
#include <spdlog/details/thread_pool.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/null_sink.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <climits>
#include <string_view>

#include "server/base/clock.h"

namespace handrail {
namespace {

// Between two looks whether the program ends, while nobody takes a line.
constexpr Nanos kLook = 20 * kMillisecond;

// Used by the log's thread alone, but for end_by() and lost().
class FdSink final : public spdlog::sinks::base_sink<spdlog::details::null_mutex> {
 public:
  explicit FdSink(int fd) : fd_(fd) {}

  void end_by(Nanos at) noexcept { end_by_ = at; }
  std::uint64_t lost() const noexcept { return lost_; }

 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    spdlog::memory_buf_t line;
    formatter_->format(message, line);
    if (!give({line.data(), line.size()})) ++lost_;
  }
  void flush_() override {}

  // What is free at once is taken at once: a write of at most PIPE_BUF bytes then does not wait.
  bool give(std::string_view text) noexcept {
    while (!text.empty()) {
      if (!writable()) return false;
      const ssize_t count = ::write(fd_, text.data(), std::min<std::size_t>(text.size(), PIPE_BUF));
      if (count < 0 && errno != EINTR && errno != EAGAIN) return false;
      if (count > 0) text.remove_prefix(static_cast<std::size_t>(count));
    }
    return true;
  }

  bool writable() const noexcept {
    for (;;) {
      const Nanos left = std::clamp<Nanos>(end_by_ - monotonic_now(), 0, kLook);
      pollfd wanted{fd_, POLLOUT, 0};
      const int ready = ::poll(&wanted, 1, static_cast<int>(left / kMillisecond));
      if (ready > 0) return true;  // or broken, as write() will say
      if (left == 0) return false;
    }
  }

  const int fd_;
  std::atomic<Nanos> end_by_{kForever};
  std::atomic<std::uint64_t> lost_{0};
};

// Signals are for the threads that serve them.
void leave_signals_to_others() {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
}

}  // namespace

struct DaemonLog::Impl {
  explicit Impl(int fd) : sink(std::make_shared<FdSink>(fd)) {}

  std::shared_ptr<FdSink> sink;
  std::shared_ptr<spdlog::details::thread_pool> thread =
      std::make_shared<spdlog::details::thread_pool>(kLines, 1, leave_signals_to_others);
};

DaemonLog::DaemonLog(const std::string& name, int fd) : impl_(std::make_unique<Impl>(fd)) {
  ::signal(SIGPIPE, SIG_IGN);
  spdlog::set_default_logger(std::make_shared<spdlog::async_logger>(
      name, impl_->sink, impl_->thread, spdlog::async_overflow_policy::overrun_oldest));
}

DaemonLog::~DaemonLog() {
  impl_->sink->end_by(monotonic_now() + kEndPatience);
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("", std::make_shared<spdlog::sinks::null_sink_mt>()));
  impl_->thread.reset();
}

std::uint64_t DaemonLog::lost() const noexcept {
  return impl_->sink->lost() + impl_->thread->overrun_counter();
}

}  // namespace handrail
