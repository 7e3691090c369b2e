// Where a program's log lines go and nobody takes them.
#pragma once

#include <fcntl.h>
#include <pty.h>
#include <unistd.h>

#include <string>

namespace handrail {

class StuckLog {
 public:
  enum class Kind {
    kTerminal,  // stopped by Ctrl-S
    kPipe,      // full, and nobody reads
    kDisk,      // full
  };
  static constexpr int kKinds = 3;

  explicit StuckLog(Kind kind) {
    if (kind == Kind::kTerminal) {
      constexpr char kStopOutput = 19;  // Ctrl-S
      if (::openpty(&ends_[0], &ends_[1], nullptr, nullptr, nullptr) != 0) return;
      for (const int end : ends_) ::fcntl(end, F_SETFD, FD_CLOEXEC);
      (void)!::write(ends_[0], &kStopOutput, 1);
    } else if (kind == Kind::kPipe) {
      if (::pipe2(ends_, O_CLOEXEC | O_NONBLOCK) != 0) return;
      const std::string page(4096, '\n');
      while (::write(ends_[1], page.data(), page.size()) > 0) {
      }
      ::fcntl(ends_[1], F_SETFL, 0);  // to the program it is a pipe like any other
    } else {
      ends_[1] = ::open("/dev/full", O_WRONLY | O_CLOEXEC);
    }
  }
  ~StuckLog() {
    for (const int end : ends_) {
      if (end >= 0) ::close(end);
    }
  }
  StuckLog(const StuckLog&) = delete;
  StuckLog& operator=(const StuckLog&) = delete;

  int fd() const { return ends_[1]; }  // for standard error; -1: there is none here

 private:
  int ends_[2] = {-1, -1};
};

}  // namespace handrail
