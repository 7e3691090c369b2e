#include "server/daemon/daemon_log.h"

#include <sched.h>
#include <signal.h>
#include <spdlog/async_logger.h>
#include <spdlog/details/null_mutex.h>
#include <spdlog/details/thread_pool.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/null_sink.h>
#include <spdlog/spdlog.h>

#include <utility>
#include <vector>

#include "server/base/clock.h"
#include "server/base/signals.h"
#include "server/daemon/fd_sink.h"

namespace handrail {
namespace {

// For the log's thread to see that its time is over: a look, and 1024 lines at some 10 us.
constexpr Nanos kEndGrace = 100 * kMillisecond;

class LineSink final : public spdlog::sinks::base_sink<spdlog::details::null_mutex> {
 public:
  explicit LineSink(std::shared_ptr<FdSink> to) : to_(std::move(to)) {}

 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    spdlog::memory_buf_t line;
    formatter_->format(message, line);
    to_->take({line.data(), line.size()});
  }
  void flush_() override { to_->flush(); }

  const std::shared_ptr<FdSink> to_;
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
      name, std::make_shared<LineSink>(impl_->sink), impl_->thread,
      spdlog::async_overflow_policy::overrun_oldest);
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
    static auto* const left_behind = new std::vector<decltype(impl_->thread)>;
    left_behind->push_back(std::move(impl_->thread));
  }
}

std::uint64_t DaemonLog::lost() const noexcept {
  return impl_->sink->lost() + impl_->thread->overrun_counter();
}

}  // namespace handrail
