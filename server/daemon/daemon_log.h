// A daemon's log: lines to standard error, written by a thread of their own.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <memory>
#include <string>

#include "server/base/time.h"

namespace handrail {

// While it lives, spdlog's default logger, for which no caller ever waits: a stopped terminal, a
// full pipe or a slow disk keeps only the log's own thread. Of the lines that wait, newer ones take
// the place of the oldest.
//
// spdlog's queue has a lock. So that a caller in real time never finds it held by a thread that
// others keep from the processor, the log's thread has the priority of that caller. It spends it on
// copies and on writes that do not wait, or sleeps.
class DaemonLog {
 public:
  static constexpr std::size_t kLines = 1024;  // that wait
  static constexpr Nanos kEndPatience = 200 * kMillisecond;

  // `name` begins every line. From here on SIGPIPE is ignored. `priority`: the highest, of
  // SCHED_FIFO, of the threads that log; where it is refused, they have none either. `fd`: open for
  // writing; where it is a terminal or a pipe, it is opened anew, for this process alone not to
  // wait. Throws spdlog::spdlog_ex or std::system_error where the system refuses a thread.
  DaemonLog(const std::string& name, int priority, int fd = STDERR_FILENO);
  // Writes what waits, for kEndPatience where nobody takes it. A write that the system does not
  // return from, as to a slow disk, is left behind after that; its thread touches nothing but what
  // is left with it.
  ~DaemonLog();
  DaemonLog(const DaemonLog&) = delete;
  DaemonLog& operator=(const DaemonLog&) = delete;

  // Lines so far that nobody will read: the reader is gone, the disk is full, or newer lines took
  // their place. From any thread.
  std::uint64_t lost() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace handrail
