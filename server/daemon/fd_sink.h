// Where a daemon's log goes: a descriptor of whatever kind, which is never waited for in vain.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <cstdint>
#include <semaphore>
#include <string_view>

#include "server/base/time.h"

namespace handrail {

// What nobody takes waits until end_by(); what then does not fit is lost and counted. take() and
// flush() are for one thread, all else for any.
class FdSink {
 public:
  // `fd`: open for writing, and longer than this. A terminal or a pipe is opened anew, for this
  // process alone not to wait.
  explicit FdSink(int fd);
  ~FdSink();
  FdSink(const FdSink&) = delete;
  FdSink& operator=(const FdSink&) = delete;

  // Writes one line, or counts it as lost. Waits while nobody takes it.
  void take(std::string_view line) noexcept {
    if (!give(line)) lose();
  }
  // Tells drained_by() that all before it has been dealt with.
  void flush() noexcept { drained_.release(); }

  void end_by(Nanos at) noexcept { end_by_ = at; }
  // Whether a flush() has come. Waits for it until `at`.
  bool drained_by(Nanos at) noexcept;
  void lose() noexcept { ++lost_; }
  std::uint64_t lost() const noexcept { return lost_; }

 private:
  // False: not all of it.
  bool give(std::string_view text) noexcept;
  ssize_t put(std::string_view text) const noexcept;
  bool writable() const noexcept;

  const int fd_;
  int own_ = -1;  // the same, without waiting; -1: it is none of those, or may not be opened
  bool socket_ = false;
  std::atomic<Nanos> end_by_{kForever};
  std::atomic<std::uint64_t> lost_{0};
  std::counting_semaphore<> drained_{0};
};

}  // namespace handrail
