// One thread of a running program that stands still, as in a dead-lock, while the others go on.
#pragma once

#include <sys/ptrace.h>
#include <sys/wait.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

namespace handrail {

// The threads of `pid` beside its first, oldest first.
inline std::vector<pid_t> other_threads(pid_t pid) {
  std::vector<pid_t> found;
  const std::string folder = "/proc/" + std::to_string(pid) + "/task";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const pid_t thread = std::stoi(entry.path().filename());
    if (thread != pid) found.push_back(thread);
  }
  std::sort(found.begin(), found.end());
  return found;
}

// Stops a thread of a child process; it goes on when this goes out of scope.
class StoppedThread {
 public:
  explicit StoppedThread(pid_t thread) : thread_(thread) {
    int status = 0;
    stopped_ = ::ptrace(PTRACE_SEIZE, thread_, nullptr, nullptr) == 0 &&
               ::ptrace(PTRACE_INTERRUPT, thread_, nullptr, nullptr) == 0 &&
               ::waitpid(thread_, &status, __WALL) == thread_;
  }
  ~StoppedThread() {
    if (stopped_) ::ptrace(PTRACE_DETACH, thread_, nullptr, nullptr);
  }
  StoppedThread(const StoppedThread&) = delete;
  StoppedThread& operator=(const StoppedThread&) = delete;

  // False: the system does not let us.
  bool stopped() const { return stopped_; }

 private:
  pid_t thread_;
  bool stopped_ = false;
};

}  // namespace handrail
