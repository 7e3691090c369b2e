#include "server/base/read_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace handrail {
namespace {

Status system_error(const std::string& path, const char* what) {
  return Status::error(path + ": " + what + ": " + std::strerror(errno));
}

}  // namespace

Result<std::string> read_file(const std::string& path, std::size_t max_bytes) {
  // Non-blocking: opening a FIFO without a writer must not wait.
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return system_error(path, "cannot open");
  struct Closer {
    int fd;
    ~Closer() { ::close(fd); }
  } closer{fd};
  struct stat info {};
  if (::fstat(fd, &info) != 0) return system_error(path, "cannot read");
  if (S_ISDIR(info.st_mode)) return Status::error(path + ": is a directory, expected a file");
  if (!S_ISREG(info.st_mode)) return Status::error(path + ": not a regular file");
  const Status too_large =
      Status::error(path + ": larger than the " + std::to_string(max_bytes) + " bytes allowed");
  std::string text;
  std::array<char, 16384> buffer;
  while (true) {
    const ssize_t n = ::read(fd, buffer.data(), buffer.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return system_error(path, "cannot read");
    if (n == 0) return text;
    text.append(buffer.data(), static_cast<std::size_t>(n));
    if (text.size() > max_bytes) return too_large;
  }
}

}  // namespace handrail
