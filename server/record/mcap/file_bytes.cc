#include "server/record/mcap/file_bytes.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace handrail {

Result<FileBytes> FileBytes::open(const std::string& path) {
  // Not to wait for who would write to a pipe: it is refused below.
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return Status::error(path + ": cannot be read: " + std::strerror(errno));
  struct stat what = {};
  const bool known = ::fstat(fd, &what) == 0;
  if (known && S_ISREG(what.st_mode)) {
    return FileBytes(path, fd, static_cast<std::uint64_t>(what.st_size));
  }
  const std::string why = known ? "is no regular file" : std::strerror(errno);
  ::close(fd);
  return Status::error(path + ": " + why);
}

FileBytes::~FileBytes() {
  if (fd_ >= 0) ::close(fd_);
}

Status FileBytes::read(std::uint64_t at, std::uint64_t size, std::string& out) const {
  out.resize(static_cast<std::size_t>(size));
  std::size_t done = 0;
  while (done < out.size()) {
    const ssize_t n =
        ::pread(fd_, out.data() + done, out.size() - done, static_cast<off_t>(at + done));
    if (n < 0 && errno == EINTR) continue;
    const std::string place = "byte " + std::to_string(at + done) + ": ";
    if (n < 0) return Status::error(place + "cannot be read: " + std::strerror(errno));
    if (n == 0) {
      return Status::error(place + "the file ends here, and had " + std::to_string(size_) +
                           " bytes when it was opened");
    }
    done += static_cast<std::size_t>(n);
    taken_ += static_cast<std::uint64_t>(n);
  }
  return Status::ok();
}

}  // namespace handrail
