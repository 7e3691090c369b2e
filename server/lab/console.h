// What the lab's commands share toward the terminal: exit codes, errors, progress.
#pragma once

#include <unistd.h>

#include <cstdio>
#include <string>

#include "server/base/status.h"

namespace handrail {

enum LabExit { kDone = 0, kFailed = 1, kUsage = 2, kCancelled = 130 };

// Says what is wrong on the error output; returns `code`.
inline int complain(const Status& status, int code) {
  std::fprintf(stderr, "handrail-lab: %s\n", status.message().c_str());
  return code;
}

// One line on the error output that is written over, on terminals only.
class Progress {
 public:
  Progress() = default;
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress() { clear(); }

  void show(const std::string& text) {
    if (!terminal_) return;
    std::fprintf(stderr, "\r\x1b[K%s", text.c_str());
    std::fflush(stderr);
    shown_ = true;
  }
  void clear() {
    if (shown_) std::fprintf(stderr, "\r\x1b[K");
    shown_ = false;
  }

 private:
  bool terminal_ = ::isatty(STDERR_FILENO) != 0;
  bool shown_ = false;
};

}  // namespace handrail
