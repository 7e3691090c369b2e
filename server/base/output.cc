#include "server/base/output.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

namespace handrail {
namespace {

Status cannot_write(const std::string& path, int error) {
  return Status::error(path + ": cannot write: " + std::strerror(error));
}

}  // namespace

int write_all(int file, const std::string& text) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t n = ::write(file, text.data() + done, text.size() - done);
    if (n > 0) done += static_cast<std::size_t>(n);
    if (n >= 0 || errno == EINTR) continue;
    if (errno != EAGAIN) return errno;
    ::pollfd room{file, POLLOUT, 0};
    (void)::poll(&room, 1, -1);
  }
  return 0;
}

NewFile::NewFile(const std::string& path) : path_(path) {
  std::error_code ignored;
  const auto whole = std::filesystem::weakly_canonical(path, ignored);
  goes_to_ = whole.empty() ? path : whole.string();
  struct ::stat there {};
  const bool exists = ::stat(goes_to_.c_str(), &there) == 0;
  if (exists && !S_ISREG(there.st_mode)) {
    file_ = ::open(goes_to_.c_str(), O_WRONLY | O_CLOEXEC);
  } else if (exists && ::access(goes_to_.c_str(), W_OK) != 0) {
    opened_ = cannot_write(path_, errno);
    return;
  } else {
    part_ = goes_to_ + "." + std::to_string(::getpid()) + ".part";
    const ::mode_t mode = exists ? there.st_mode & 07777 : 0666;
    file_ = ::open(part_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, mode);
  }
  if (file_ < 0) opened_ = cannot_write(path_, errno);
}

NewFile::~NewFile() {
  if (file_ < 0) return;
  ::close(file_);
  if (!part_.empty()) ::unlink(part_.c_str());
}

Status NewFile::finish(const std::string& text) {
  if (!opened_) return opened_;
  int error = write_all(file_, text);
  if (error == 0 && !part_.empty() && ::fsync(file_) != 0) error = errno;
  // A disk on the network may say only now that it is full.
  if (::close(file_) != 0 && error == 0) error = errno;
  file_ = -1;
  if (part_.empty()) return error == 0 ? Status::ok() : cannot_write(path_, error);
  if (error == 0 && ::rename(part_.c_str(), goes_to_.c_str()) != 0) error = errno;
  if (error == 0) return Status::ok();
  ::unlink(part_.c_str());
  return cannot_write(path_, error);
}

Status write_file(const std::string& path, const std::string& text) {
  return NewFile(path).finish(text);
}

int end_output(const std::string& program, int code) {
  errno = 0;
  const bool written = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  if (written) return code;
  const std::string why = errno == 0 ? "" : std::string(": ") + std::strerror(errno);
  std::fprintf(stderr, "%s: the standard output cannot be written%s\n", program.c_str(),
               why.c_str());
  return code == 0 ? 1 : code;
}

}  // namespace handrail
