#include "server/record/recording_sink.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace handrail {
namespace {

Status disk_says(const std::string& path, const char* what) {
  return Status::error(path + ": " + what + ": " + std::strerror(errno));
}

}  // namespace

Result<RecordingSink> RecordingSink::make(const std::string& path, const McapLayout& layout) {
  // What a hand did is nobody else's to read.
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (fd < 0) return disk_says(path, "cannot be made");
  RecordingSink out(fd, path, layout);
  if (Status begun = out.put(out.file_.begin(), 0); !begun) {
    // Nobody could read a file without a beginning.
    ::unlink(path.c_str());
    return begun;
  }
  return Result<RecordingSink>(std::move(out));
}

RecordingSink::RecordingSink(RecordingSink&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)),
      path_(std::move(other.path_)),
      file_(std::move(other.file_)) {}

RecordingSink::~RecordingSink() {
  if (fd_ >= 0) ::close(fd_);
}

Status RecordingSink::put(std::string_view bytes, std::uint64_t at) {
  const auto begin = static_cast<off_t>(at);
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n =
        ::pwrite(fd_, bytes.data() + done, bytes.size() - done, begin + static_cast<off_t>(done));
    if (n < 0 && errno == EINTR) continue;
    if (n > 0) {
      done += static_cast<std::size_t>(n);
      continue;
    }
    Status failed = disk_says(path_, "cannot be written");
    // Half a chunk would end the file for whoever reads it.
    if (::ftruncate(fd_, begin) != 0)
      return disk_says(path_, "cannot be cut to its last whole chunk");
    return failed;
  }
  return Status::ok();
}

bool RecordingSink::removed() const noexcept {
  struct stat now {};
  return ::fstat(fd_, &now) == 0 && now.st_nlink == 0;
}

Status RecordingSink::write(const McapChunk& chunk) {
  if (Status done = put(chunk.bytes, file_.size()); !done) return done;
  file_.add(chunk);
  return Status::ok();
}

Status RecordingSink::finish() {
  Status done = put(file_.end(), file_.size());
  if (::close(std::exchange(fd_, -1)) != 0 && done) return disk_says(path_, "cannot be closed");
  return done;
}

}  // namespace handrail
