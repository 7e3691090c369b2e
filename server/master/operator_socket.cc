#include "server/master/operator_socket.h"

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

Status failure(const std::string& path, const std::string& what) {
  return Status::error("operator socket " + path + ": " + what);
}
Status failure(const std::string& path, const char* what, int cause) {
  return failure(path, std::string(what) + ": " + std::strerror(cause));
}

Status make_folder(const std::string& path, const std::string& folder) {
  std::error_code error;
  const std::filesystem::path above = std::filesystem::path(folder).parent_path();
  if (!above.empty()) std::filesystem::create_directories(above, error);
  if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) {
    return failure(path, ("cannot create " + folder).c_str(), errno);
  }
  const Result<FolderOwner> owner = folder_owner(folder);
  if (!owner) return failure(path, owner.message());
  if (owner->user == ::geteuid() || owner->user == 0) return Status::ok();
  return failure(path, folder + " is a folder of " + owner->text + ", expected one of " +
                           user_text(::geteuid()) + " or root");
}

// Removes what an ended master left at `path`; fails on anything else.
Status clear_stale(const std::string& path, const sockaddr_un& address) {
  struct stat info {};
  if (::lstat(path.c_str(), &info) != 0) return Status::ok();
  if (!S_ISSOCK(info.st_mode)) return failure(path, "exists and is not a socket");
  const Fd probe(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int result =
      ::connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address));
  if (result == 0 || errno == EAGAIN) return failure(path, "another master answers on it");
  if (errno != ECONNREFUSED) return failure(path, "cannot tell whether it is in use", errno);
  if (::unlink(path.c_str()) != 0) return failure(path, "cannot remove the stale file", errno);
  return Status::ok();
}

// Waits for its turn among masters that start at once, which takes each some milliseconds.
bool locked(int folder) {
  const Nanos give_up = monotonic_now() + kSecond;
  while (::flock(folder, LOCK_EX | LOCK_NB) != 0) {
    if (monotonic_now() > give_up) return false;
    sleep_until(monotonic_now() + 5 * kMillisecond);
  }
  return true;
}

}  // namespace

Status OperatorSocket::claim(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof(address.sun_path)) {
    return failure(path, "the path has " + std::to_string(path.size()) + " bytes, expected 1 to " +
                             std::to_string(sizeof(address.sun_path) - 1));
  }
  std::copy(path.begin(), path.end(), address.sun_path);
  const std::string parent = std::filesystem::path(path).parent_path().string();
  const std::string folder = parent.empty() ? std::string(".") : parent;
  if (Status s = make_folder(path, folder); !s) return s;

  // Held while claiming, so that of two masters starting at once one sees the other.
  const Fd lock(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (lock.get() >= 0 && !locked(lock.get())) {
    return failure(path, folder + " has been locked for a second");
  }
  if (Status s = clear_stale(path, address); !s) return s;
  Fd fd(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (fd.get() < 0) return failure(path, "cannot create", errno);
  if (::bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    return failure(path, "cannot bind", errno);
  }
  path_ = path;
  struct stat info {};
  if (::lstat(path.c_str(), &info) == 0) {
    device_ = info.st_dev;
    inode_ = info.st_ino;
  }
  // Nobody can connect before listen, so the mode is right in time.
  if (::chmod(path.c_str(), 0600) != 0 || ::listen(fd.get(), SOMAXCONN) != 0) {
    const int cause = errno;
    remove();
    return failure(path, "cannot listen", cause);
  }
  fd_ = fd.release();
  return Status::ok();
}

int OperatorSocket::release() noexcept { return std::exchange(fd_, -1); }

void OperatorSocket::remove() noexcept {
  if (fd_ >= 0) ::close(std::exchange(fd_, -1));
  struct stat info {};
  if (!path_.empty() && ::lstat(path_.c_str(), &info) == 0 && info.st_dev == device_ &&
      info.st_ino == inode_) {
    ::unlink(path_.c_str());
  }
  path_.clear();
}

}  // namespace handrail
