// A program of the build, run by a test: what it printed, and how it ended.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "tests/support/temp_folder.h"

namespace handrail {

// Standard output and error go to one file, so that a program never waits for its reader. Ends the
// program, if it still runs, when it goes out of scope.
class Program {
 public:
  // No test needs that long, whatever else the machine does.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  static constexpr Nanos kPatience = 240 * kSecond;  // programs with checks put in are slow
#else
  static constexpr Nanos kPatience = 30 * kSecond;
#endif

  // `name`: of a program in the build's bin folder.
  Program(const TempFolder& folder, const std::string& name, std::vector<std::string> arguments) {
    static int count = 0;
    output_path_ = folder.path() + "/" + name + "-" + std::to_string(++count) + ".out";
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 1, output_path_.c_str(),
                                     O_WRONLY | O_CREAT | O_APPEND, 0600);
    posix_spawn_file_actions_adddup2(&actions, 1, 2);
    std::string path = std::string(HANDRAIL_BIN_DIR "/") + name;
    std::vector<char*> argv{path.data()};
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    const int error = ::posix_spawn(&pid_, path.c_str(), &actions, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (error != 0) pid_ = -1;
    EXPECT_EQ(error, 0) << "cannot start " << path;
  }
  ~Program() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  // Everything printed so far.
  std::string output() const {
    std::ostringstream text;
    text << std::ifstream(output_path_).rdbuf();
    return text.str();
  }
  // Waits for `part` in the output; what follows it up to the line's end, "" when it never comes.
  std::string after(const std::string& part) {
    const Nanos give_up = monotonic_now() + kPatience;
    for (;;) {
      const bool ended = !running();
      const std::string all = output();
      const std::size_t start = all.find(part);
      const std::size_t end = start == std::string::npos ? start : all.find('\n', start);
      if (end != std::string::npos) {
        return all.substr(start + part.size(), end - start - part.size());
      }
      if (ended || monotonic_now() > give_up) break;
      sleep_until(monotonic_now() + 5 * kMillisecond);
    }
    ADD_FAILURE() << "no '" << part << "' in: " << output();
    return "";
  }
  // The number that follows `part`; 0 when there is none.
  int number_after(const std::string& part) { return std::atoi(after(part).c_str()); }

  pid_t pid() const { return pid_; }
  void send(int signal) const { ::kill(pid_, signal); }
  bool running() {
    if (pid_ <= 0) return false;
    if (::waitpid(pid_, &status_, WNOHANG) != pid_) return true;
    pid_ = 0;
    return false;
  }
  // Waits for the end: the exit code, or minus the signal that ended it.
  int finish() {
    const Nanos give_up = monotonic_now() + kPatience;
    while (running()) {
      if (monotonic_now() > give_up) {
        ADD_FAILURE() << "does not end; printed: " << output();
        ::kill(pid_, SIGKILL);
      }
      sleep_until(monotonic_now() + 2 * kMillisecond);
    }
    return WIFEXITED(status_) ? WEXITSTATUS(status_) : -WTERMSIG(status_);
  }
  void kill() {
    send(SIGKILL);
    EXPECT_EQ(finish(), -SIGKILL);
  }

 private:
  std::string output_path_;
  pid_t pid_ = -1;
  int status_ = 0;
};

}  // namespace handrail
