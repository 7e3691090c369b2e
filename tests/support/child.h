// A program of the build as a child process; asks nothing of a test framework.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace handrail {

// Where a child's streams go instead of to its file.
struct Streams {
  int output = -1, error = -1;  // open here; -1: to the file
  // Of a pseudo-terminal. The child leads a session that it controls, reads it, and writes its
  // error output there.
  std::string terminal = {};
  bool ignores_hang_up = false;  // as the children of nohup do, where this process does
};

// Standard output and error go to one file, so that a program never waits for its reader. Ends the
// program, if it still runs, when it goes out of scope.
class Child {
 public:
  // `name`: of a program in the build's bin folder, or a path from the root. Output is added to the
  // file at `output_path`. `own_group`: a terminal's Ctrl-C does not reach it.
  Child(const std::string& name, std::vector<std::string> arguments, std::string output_path,
        bool own_group = false, const Streams& streams = {})
      : path_(name.starts_with('/') ? name : HANDRAIL_BIN_DIR "/" + name),
        output_path_(std::move(output_path)) {
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 1, output_path_.c_str(),
                                     O_WRONLY | O_CREAT | O_APPEND, 0600);
    if (!streams.terminal.empty()) {
      posix_spawn_file_actions_addopen(&actions, 0, streams.terminal.c_str(), O_RDWR, 0);
    }
    const int terminal = streams.terminal.empty() ? 1 : 0;
    posix_spawn_file_actions_adddup2(&actions, streams.error >= 0 ? streams.error : terminal, 2);
    if (streams.output >= 0) posix_spawn_file_actions_adddup2(&actions, streams.output, 1);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    short flags = 0;
    if (own_group) flags |= POSIX_SPAWN_SETPGROUP;
    if (!streams.terminal.empty()) flags |= POSIX_SPAWN_SETSID;
    // Who started the tests by nohup has it ignored; a child would take that over.
    if (!streams.ignores_hang_up) {
      flags |= POSIX_SPAWN_SETSIGDEF;
      sigset_t hang_up;
      sigemptyset(&hang_up);
      sigaddset(&hang_up, SIGHUP);
      posix_spawnattr_setsigdefault(&attributes, &hang_up);
    }
    posix_spawnattr_setflags(&attributes, flags);
    std::vector<char*> argv{path_.data()};
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    error_ = ::posix_spawn(&pid_, path_.c_str(), &actions, &attributes, argv.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    if (error_ != 0) pid_ = 0;
  }
  ~Child() {
    if (pid_ <= 0) return;
    send(SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  const std::string& path() const { return path_; }
  int start_error() const { return error_; }  // 0: it was started
  pid_t pid() const { return pid_; }          // 0: it does not run
  void send(int signal) const {
    if (pid_ > 0) ::kill(pid_, signal);
  }
  bool running() {
    if (pid_ <= 0) return false;
    if (::waitpid(pid_, &status_, WNOHANG) != pid_) return true;
    pid_ = 0;
    return false;
  }
  // The exit code, or minus the signal that ended it. When it has ended.
  int code() const { return WIFEXITED(status_) ? WEXITSTATUS(status_) : -WTERMSIG(status_); }

  // Everything printed so far.
  std::string output() const {
    std::ostringstream text;
    text << std::ifstream(output_path_).rdbuf();
    return text.str();
  }
  // What follows `part` in the output so far, up to the line's end; nothing while that line is not
  // there.
  bool printed(const std::string& part, std::string& rest) const {
    const std::string all = output();
    const std::size_t start = all.find(part);
    const std::size_t end = start == std::string::npos ? start : all.find('\n', start);
    if (end == std::string::npos) return false;
    rest = all.substr(start + part.size(), end - start - part.size());
    return true;
  }

 private:
  std::string path_, output_path_;
  pid_t pid_ = 0;
  int error_ = 0;
  int status_ = 0;
};

}  // namespace handrail
