// What the lab's commands share toward the terminal: exit codes, errors, progress.
#pragma once

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <future>
#include <string>

#include "server/base/clock.h"
#include "server/base/status.h"

namespace handrail {

enum LabExit { kDone = 0, kFailed = 1, kUsage = 2, kCancelled = 130 };

// Says what is wrong on the error output; returns `code`.
inline int complain(const Status& status, int code) {
  std::fprintf(stderr, "handrail-lab: %s\n", status.message().c_str());
  return code;
}

// How far long work has come: on a terminal one line that is written over, elsewhere a plain line
// every `plain` or so, as often as there is something to show. Not thread-safe.
class Progress {
 public:
  static constexpr Nanos kPlain = 10 * kSecond;  // a log that is looked at lives, and stays short

  explicit Progress(std::FILE* to = stderr, Nanos plain = kPlain)
      : to_(to), terminal_(::isatty(::fileno(to)) != 0), plain_(plain) {}
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress() { clear(); }

  void show(const std::string& text) {
    if (terminal_) {
      std::fprintf(to_, "\r\x1b[K%s", text.c_str());
      shown_ = true;
    } else if (const Nanos now = monotonic_now(); now >= next_) {
      std::fprintf(to_, "%s\n", text.c_str());
      next_ = now + plain_;
    }
    std::fflush(to_);
  }
  void clear() {
    if (shown_) std::fprintf(to_, "\r\x1b[K");
    shown_ = false;
  }

 private:
  std::FILE* to_;
  bool terminal_;
  Nanos plain_;
  Nanos next_ = monotonic_now() + plain_;
  bool shown_ = false;
};

// Runs `work` on a thread of its own and returns what it does. From Ctrl-C on it has a second to
// end; then `give_up` says so and its exit code ends the program.
template <typename Work, typename GiveUp>
auto run_until_cancelled(const Work& work, const std::atomic<bool>& cancelled,
                         const GiveUp& give_up) {
  constexpr auto kLook = std::chrono::milliseconds(50);
  constexpr int kLooks = 20;
  auto running = std::async(std::launch::async, work);
  for (int left = kLooks; running.wait_for(kLook) != std::future_status::ready;) {
    if (cancelled && --left == 0) std::_Exit(give_up());
  }
  return running.get();
}

}  // namespace handrail
