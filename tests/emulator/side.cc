#include "tests/emulator/side.h"

#include <sched.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <system_error>

#include "tests/emulator/fd_message.h"
#include "tests/emulator/tun.h"

namespace handrail::emulator {
namespace {

constexpr unsigned long kOwnSpaces = CLONE_NEWNET | CLONE_NEWNS | CLONE_NEWIPC | CLONE_NEWPID;

// As fork, with the child the first process of new namespaces.
pid_t fork_into(unsigned long spaces) {
  return static_cast<pid_t>(::syscall(SYS_clone, spaces | SIGCHLD, nullptr, nullptr, nullptr, 0));
}

std::string reason(int error) { return std::generic_category().message(error); }

}  // namespace

bool SideProgram::good() const {
  return ended && problem.empty() && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

std::string SideProgram::ending() const {
  if (!problem.empty()) return "cannot run: " + problem;
  if (!ended) return "runs";
  if (WIFEXITED(status)) return "exit " + std::to_string(WEXITSTATUS(status));
  return "signal " + std::to_string(WTERMSIG(status));
}

SideHost::~SideHost() {
  if (pid_ > 0) {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  if (socket_ >= 0) ::close(socket_);
  if (wire_ >= 0) ::close(wire_);
}

Status SideHost::start(const SideSetup& setup) {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    return Status::error("a pair of sockets: " + reason(errno));
  }
  const int on = 1;
  ::setsockopt(ends[0], SOL_SOCKET, SO_PASSCRED, &on, sizeof on);
  const unsigned user = ::geteuid(), group = ::getegid();
  std::fflush(nullptr);  // else both processes print what waits
  bool own_user = user != 0;
  pid_ = fork_into(kOwnSpaces | (own_user ? CLONE_NEWUSER : 0));
  // A root that may not make namespaces, as in a container, may still be root of its own.
  if (pid_ < 0 && !own_user) {
    own_user = true;
    pid_ = fork_into(kOwnSpaces | CLONE_NEWUSER);
  }
  const int error = errno;
  if (pid_ == 0) be_side(ends[1], setup, own_user, user, group);
  ::close(ends[1]);
  socket_ = ends[0];
  if (pid_ < 0) {
    return Status::error(
        "namespaces of its own: " + reason(error) +
        (error == ENOSPC ? " (see sysctl user.max_net_namespaces and the like)" : ""));
  }
  const auto answer = receive_message(socket_);
  if (!answer || answer->words.empty()) return Status::error("its first process ended at once");
  if (answer->words[0] == kRefused) return Status::error(answer->words.back());
  wire_ = answer->fd;
  return Status::ok();
}

Status SideHost::run(const std::string& name, const std::vector<std::string>& words, int output) {
  if (programs_.contains(name)) return Status::error("'" + name + "' has run already");
  FdMessage message{.words = {kRun, name}, .fd = output};
  message.words.insert(message.words.end(), words.begin(), words.end());
  if (!send_message(socket_, message)) return Status::error("'" + name + "': the side is gone");
  programs_[name] = {};
  return Status::ok();
}

void SideHost::signal(const std::string& name, int number) {
  (void)send_message(socket_, {.words = {kSignal, name, std::to_string(number)}});
}

bool SideHost::take_news() {
  const auto news = receive_message(socket_);
  if (!news) return false;
  const auto& words = news->words;
  if (words.size() < 2) return true;
  SideProgram& program = programs_[words[1]];
  if (words[0] == kStarted) program.pid = news->from;
  if (words[0] == kFailed) program.problem = words.back();
  if (words[0] == kFailed || words[0] == kEnded) program.ended = true;
  if (words[0] == kEnded) program.status = std::atoi(words[2].c_str());
  return true;
}

// A line of /proc/net/dev: "hr0: bytes packets errs drop fifo frame compressed multicast" of what
// came in, then "bytes packets errs drop" of what went out.
std::uint64_t SideHost::missed() const {
  std::ifstream devices("/proc/" + std::to_string(pid_) + "/net/dev");
  const std::string start = kTunName + std::string(":");
  for (std::string line; std::getline(devices, line);) {
    const std::size_t at = line.find(start);
    if (at == std::string::npos) continue;
    std::istringstream in(line.substr(at + start.size()));
    std::array<std::uint64_t, 12> fields{};
    for (std::uint64_t& field : fields) in >> field;
    return fields[11];
  }
  return 0;
}

}  // namespace handrail::emulator
