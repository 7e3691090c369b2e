#include "tests/emulator/side_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <system_error>
#include <utility>

#include "server/base/status.h"
#include "tests/emulator/fd_message.h"
#include "tests/emulator/tun.h"

namespace handrail::emulator {
namespace {

// Where programs put what others are to find: empty here, and this side's alone.
constexpr std::array<const char*, 4> kPrivate = {"/tmp", "/var/tmp", "/dev/shm", "/run"};
constexpr const char* kHome = "/tmp/home";
constexpr const char* kRuntime = "/tmp/run";
constexpr int kNotStarted = 127;  // as a shell's

Status cannot(const std::string& what) {
  return Status::error(what + ": " + std::generic_category().message(errno));
}

bool write_to(const char* path, const std::string& text) {
  const int file = ::open(path, O_WRONLY | O_CLOEXEC);
  if (file < 0) return false;
  const bool written = ::write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  ::close(file);
  return written;
}

// Users and groups within are those without.
Status map_users(unsigned user, unsigned group) {
  const auto one = [](unsigned id) {
    return std::to_string(id) + " " + std::to_string(id) + " 1\n";
  };
  if (!write_to("/proc/self/setgroups", "deny")) return cannot("/proc/self/setgroups");
  if (!write_to("/proc/self/uid_map", one(user))) return cannot("/proc/self/uid_map");
  if (!write_to("/proc/self/gid_map", one(group))) return cannot("/proc/self/gid_map");
  return Status::ok();
}

// A folder that will be covered is reached through its descriptor.
Status put_back(const std::string& folder, int descriptor) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  const std::string through = "/proc/self/fd/" + std::to_string(descriptor);
  if (::mount(through.c_str(), folder.c_str(), nullptr, MS_BIND | MS_REC, nullptr) != 0) {
    return cannot(folder);
  }
  return Status::ok();
}

Status make_private(const std::vector<std::string>& shared) {
  if (::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0) return cannot("mount /");
  std::vector<int> kept;
  for (const std::string& folder : shared) {
    kept.push_back(::open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
    if (kept.back() < 0) return cannot(folder);
  }
  for (const char* place : kPrivate) {
    struct stat there {};
    if (::stat(place, &there) != 0) continue;
    if (::mount("tmpfs", place, "tmpfs", MS_NOSUID | MS_NODEV, "mode=1777") != 0) {
      return cannot("mount " + std::string(place));
    }
  }
  for (std::size_t i = 0; i < shared.size(); ++i) {
    if (Status done = put_back(shared[i], kept[i]); !done) return done;
  }
  // Where a container forbids it, /proc/self is right all the same.
  (void)::mount("proc", "/proc", "proc", MS_NOSUID | MS_NODEV | MS_NOEXEC, nullptr);
  (void)write_to("/proc/sys/net/ipv6/conf/all/disable_ipv6", "0");
  (void)write_to("/proc/sys/net/ipv6/conf/default/disable_ipv6", "0");
  for (const int descriptor : kept) ::close(descriptor);
  for (const char* folder : {kHome, kRuntime}) {
    if (::mkdir(folder, 0700) != 0) return cannot(folder);
  }
  return Status::ok();
}

void set_environment(Side side) {
  ::setenv("HOME", kHome, 1);
  ::setenv("XDG_RUNTIME_DIR", kRuntime, 1);
  ::setenv("TMPDIR", "/tmp", 1);
  ::setenv("HANDRAIL_SIDE", name_of(side), 1);
}

Result<int> make_side(const SideSetup& setup, bool own_user, unsigned user, unsigned group) {
  if (own_user) {
    if (Status mapped = map_users(user, group); !mapped) return mapped;
  }
  if (Status made = make_private(setup.shared); !made) return made;
  set_environment(setup.side);
  return open_wire(setup.side, setup.mtu);
}

// Becomes the program; never returns.
[[noreturn]] void be_program(int socket, const std::string& name,
                             std::vector<std::string> arguments, int output) {
  ::setsid();
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  for (const int signal : {SIGPIPE, SIGHUP, SIGINT, SIGTERM}) ::signal(signal, SIG_DFL);
  if (output >= 0) {
    ::dup2(output, 1);
    ::dup2(output, 2);
  }
  const int nothing = ::open("/dev/null", O_RDONLY);
  if (nothing > 0) ::dup2(nothing, 0);
  (void)send_message(socket, {.words = {kStarted, name}});
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  ::execvp(argv.front(), argv.data());
  (void)send_message(socket, {.words = {kFailed, name, cannot(arguments.front()).message()}});
  ::_exit(kNotStarted);
}

class Host {
 public:
  explicit Host(int socket) : socket_(socket) {
    sigset_t children;
    sigemptyset(&children);
    sigaddset(&children, SIGCHLD);
    ::sigprocmask(SIG_BLOCK, &children, nullptr);
    ended_ = ::signalfd(-1, &children, SFD_CLOEXEC | SFD_NONBLOCK);
  }

  // Until the emulator goes.
  void serve() {
    for (;;) {
      std::array<pollfd, 2> wait{pollfd{socket_, POLLIN, 0}, pollfd{ended_, POLLIN, 0}};
      if (::poll(wait.data(), wait.size(), -1) < 0) continue;
      if (wait[1].revents != 0) reap();
      if (wait[0].revents == 0) continue;
      const auto message = receive_message(socket_);
      if (!message) return;
      obey(*message);
      if (message->fd >= 0) ::close(message->fd);
    }
  }

 private:
  void obey(const FdMessage& message) {
    if (message.words.size() < 3) return;
    const std::string& name = message.words[1];
    if (message.words[0] == kRun) {
      const pid_t pid = ::fork();
      if (pid == 0) {
        be_program(socket_, name, {message.words.begin() + 2, message.words.end()}, message.fd);
      }
      if (pid > 0) programs_[pid] = name;
      if (pid < 0)
        (void)send_message(socket_, {.words = {kFailed, name, cannot("fork").message()}});
    } else if (message.words[0] == kSignal) {
      for (const auto& [pid, of] : programs_) {
        const int signal = std::atoi(message.words[2].c_str());
        // With whatever it has started, once it leads a group.
        if (of == name && ::kill(-pid, signal) != 0) ::kill(pid, signal);
      }
    }
  }

  void reap() {
    signalfd_siginfo news{};
    while (::read(ended_, &news, sizeof news) > 0) {
    }
    for (int status = 0;;) {
      const pid_t pid = ::waitpid(-1, &status, WNOHANG);
      if (pid <= 0) return;
      const auto found = programs_.find(pid);
      if (found == programs_.end()) continue;  // an orphan of one of them
      (void)send_message(socket_, {.words = {kEnded, found->second, std::to_string(status)}});
      programs_.erase(found);
    }
  }

  int socket_, ended_ = -1;
  std::map<pid_t, std::string> programs_;
};

}  // namespace

void be_side(int socket, const SideSetup& setup, bool own_user, unsigned user, unsigned group) {
  // An emulator that went before this is found out at the first receive.
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  // Nothing of the emulator's, nor of the other side, is kept open here.
  constexpr int kOwn = 3;
  if (socket != kOwn) socket = ::dup3(socket, kOwn, O_CLOEXEC);
  ::close_range(kOwn + 1, ~0u, 0);
  const Result<int> wire = make_side(setup, own_user, user, group);
  if (!wire) {
    (void)send_message(socket, {.words = {kRefused, wire.message()}});
    ::_exit(1);
  }
  (void)send_message(socket, {.words = {kReady}, .fd = *wire});
  ::close(*wire);
  Host(socket).serve();
  ::_exit(0);
}

}  // namespace handrail::emulator
