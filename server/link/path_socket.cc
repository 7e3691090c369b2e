#include "server/link/path_socket.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "server/base/clock.h"
#include "server/base/folder_owner.h"
#include "server/base/pacer.h"

namespace handrail {
namespace {

class Fd {
 public:
  explicit Fd(int fd) : fd_(fd) {}
  ~Fd() {
    if (fd_ >= 0) ::close(fd_);
  }
  Fd(const Fd&) = delete;
  Fd& operator=(const Fd&) = delete;
  int get() const { return fd_; }
  int release() { return std::exchange(fd_, -1); }

 private:
  int fd_;
};

using Problem = std::string;  // empty: none

Problem because(const std::string& what, int cause) { return what + ": " + std::strerror(cause); }

Problem make_folder(const std::string& folder) {
  std::error_code error;
  const std::filesystem::path above = std::filesystem::path(folder).parent_path();
  if (!above.empty()) std::filesystem::create_directories(above, error);
  if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) {
    return because("cannot create " + folder, errno);
  }
  const Result<FolderOwner> owner = folder_owner(folder);
  if (!owner) return owner.message();
  if (owner->user == ::geteuid() || owner->user == 0) return {};
  return folder + " is a folder of " + owner->text + ", expected one of " + user_text(::geteuid()) +
         " or root";
}

// Where `path` is, whatever links lead to its folder.
std::string without_links(const std::string& path, const std::string& folder) {
  std::error_code error;
  const std::filesystem::path real = std::filesystem::canonical(folder, error);
  return error ? path : (real / std::filesystem::path(path).filename()).string();
}

// Removes what an ended program left at `path`; fails on anything else.
Problem clear_stale(const std::string& path, const sockaddr_un& address, PathSocketKind kind) {
  struct stat info {};
  if (::lstat(path.c_str(), &info) != 0) return {};
  if (!S_ISSOCK(info.st_mode)) return "exists and is not a socket";
  const Fd probe(::socket(AF_UNIX, kind.type | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int result =
      ::connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address));
  if (result == 0 || errno == EAGAIN) return std::string(kind.rival) + " answers on it";
  if (errno != ECONNREFUSED) return because("cannot tell whether it is in use", errno);
  if (::unlink(path.c_str()) != 0) return because("cannot remove the stale file", errno);
  return {};
}

// What arrives before the kernel was asked for senders would have none.
bool asks_for_senders(int fd) {
  const int yes = 1;
  return ::setsockopt(fd, SOL_SOCKET, SO_PASSCRED, &yes, sizeof yes) == 0;
}

// Waits for its turn among programs that start at once, which takes each some milliseconds.
bool locked(int folder) {
  const Nanos give_up = monotonic_now() + kSecond;
  while (::flock(folder, LOCK_EX | LOCK_NB) != 0) {
    if (monotonic_now() > give_up) return false;
    sleep_until(monotonic_now() + 5 * kMillisecond);
  }
  return true;
}

}  // namespace

Status PathSocket::claim(const std::string& path) {
  const auto failure = [&](const std::string& what) {
    return Status::error(std::string(kind_.role) + " " + path + ": " + what);
  };
  const std::string parent = std::filesystem::path(path).parent_path().string();
  const std::string folder = parent.empty() ? std::string(".") : parent;
  const bool datagrams = kind_.type == SOCK_DGRAM;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const auto too_long = [&](const std::string& at) -> Problem {
    if (!at.empty() && at.size() < sizeof(address.sun_path)) return {};
    return "the path has " + std::to_string(at.size()) + " bytes, expected 1 to " +
           std::to_string(sizeof(address.sun_path) - 1);
  };
  if (const Problem p = too_long(path); !p.empty()) return failure(p);
  if (const Problem p = make_folder(folder); !p.empty()) return failure(p);
  const std::string at = datagrams ? without_links(path, folder) : path;
  if (const Problem p = too_long(at); !p.empty()) return failure("is " + at + ", and " + p);
  std::copy(at.begin(), at.end(), address.sun_path);

  // Held while claiming, so that of two programs starting at once one sees the other.
  const Fd lock(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (lock.get() >= 0 && !locked(lock.get())) {
    return failure(folder + " has been locked for a second");
  }
  if (const Problem p = clear_stale(at, address, kind_); !p.empty()) return failure(p);
  Fd fd(::socket(AF_UNIX, kind_.type | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (fd.get() < 0) return failure(because("cannot create", errno));
  if (datagrams && !asks_for_senders(fd.get())) {
    return failure(because("cannot be told who sends", errno));
  }
  // The file gets the mode of the socket.
  if (::fchmod(fd.get(), 0600) != 0 ||
      ::bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    return failure(because("cannot bind", errno));
  }
  path_ = at;
  struct stat info {};
  if (::lstat(at.c_str(), &info) == 0) {
    device_ = info.st_dev;
    inode_ = info.st_ino;
  }
  if (!datagrams && ::listen(fd.get(), SOMAXCONN) != 0) {
    const int cause = errno;
    remove();
    return failure(because("cannot listen", cause));
  }
  fd_ = fd.release();
  return Status::ok();
}

int PathSocket::release() noexcept { return std::exchange(fd_, -1); }

void PathSocket::remove() noexcept {
  if (fd_ >= 0) ::close(std::exchange(fd_, -1));
  struct stat info {};
  if (!path_.empty() && ::lstat(path_.c_str(), &info) == 0 && info.st_dev == device_ &&
      info.st_ino == inode_) {
    ::unlink(path_.c_str());
  }
  path_.clear();
}

}  // namespace handrail
