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
class DaemonLog {
 public:
  static constexpr std::size_t kLines = 1024;  // that wait
  static constexpr Nanos kEndPatience = 200 * kMillisecond;

  // `name` begins every line. From here on SIGPIPE is ignored. `fd`: open for writing.
  explicit DaemonLog(const std::string& name, int fd = STDERR_FILENO);
  // Writes what waits, for kEndPatience at most where nobody takes it.
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
